#include "client/candump_line.hpp"

#include <array>
#include <cstdio>
#include <string_view>

namespace rc10::client {
namespace {

using namespace blackbox;

constexpr std::string_view kDigits = "0123456789ABCDEF";
constexpr std::uint32_t kStandardMask = 0x7FFU;
constexpr std::uint32_t kExtendedMask = 0x1FFF'FFFFU;

void appendHex(std::string& text, std::uint32_t value, int digits) {
  for (int digit = digits - 1; digit >= 0; --digit) text += kDigits[value >> (4 * digit) & 0xFU];
}

}  // namespace

std::string frameText(const Frame& frame) {
  const auto id = frame.header.id;
  const auto flags = frame.header.flags;
  std::string text;
  // can-utils print an error frame as an id of eight digits with its flag.
  if ((id & kIdError) != 0) {
    appendHex(text, id & (kExtendedMask | kIdError), 8);
  } else if ((id & kIdExtended) != 0) {
    appendHex(text, id & kExtendedMask, 8);
  } else {
    appendHex(text, id & kStandardMask, 3);
  }
  text += '#';
  if ((flags & kFrameFd) != 0) {
    text += '#';
    appendHex(text, (flags & kFrameBitRateSwitch) != 0 ? 1 : 0, 1);  // CANFD_BRS
  }
  const std::size_t bytes = payloadBytes(flags);
  if ((id & kIdRemote) != 0) {
    text += 'R';
    if (bytes > 0) appendHex(text, static_cast<std::uint32_t>(bytes), 1);
    return text;
  }
  for (std::size_t i = 0; i < bytes; ++i) appendHex(text, frame.data[i], 2);
  return text;
}

std::string candumpLine(const Recording& recording, const Frame& frame) {
  const auto us = recording.wallUs(frame.header.time_ns);
  std::array<char, 40> time{};
  const bool sane = us >= 0;
  std::snprintf(time.data(), time.size(), "(%010lld.%06lld) ",
                sane ? static_cast<long long>(us / 1'000'000) : 0,
                sane ? static_cast<long long>(us % 1'000'000) : 0);
  return time.data() + std::string(recording.interfaceName(frame.header.source)) + ' ' + frameText(frame) +
         ((frame.header.flags & kFrameSent) != 0 ? " T" : " R");
}

}  // namespace rc10::client
