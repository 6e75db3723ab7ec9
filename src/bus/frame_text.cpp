#include "bus/frame_text.hpp"

#include <net/if.h>

#include <algorithm>
#include <optional>

#include "app/hex_text.hpp"

namespace rc10 {
namespace {

constexpr unsigned kStandardDigits = 3;
constexpr unsigned kExtendedDigits = 8;
constexpr unsigned kBitRateSwitch = 1;

std::string excerpt(std::string_view text) { return "'" + std::string{text.substr(0, 200)} + "'"; }

std::optional<unsigned> digit(char c) noexcept {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
  return std::nullopt;
}

/// At most 8 digits.
std::optional<std::uint32_t> number(std::string_view digits) noexcept {
  std::uint32_t value = 0;
  for (const char c : digits) {
    const auto next = digit(c);
    if (!next) return std::nullopt;
    value = value << 4U | *next;
  }
  return digits.empty() ? std::nullopt : std::optional{value};
}

Result<CanId> parseId(std::string_view digits) {
  const bool extended = digits.size() == kExtendedDigits;
  const auto value = extended || digits.size() == kStandardDigits ? number(digits) : std::nullopt;
  if (!value || *value > idMask(extended)) {
    return fail("the id " + excerpt(digits) + " is not 3 digits up to 7FF, nor 8 up to 1FFFFFFF");
  }
  return CanId{*value, extended};
}

Result<void> parsePayload(std::string_view digits, CanFrame& frame) {
  const std::size_t length = digits.size() / 2;
  if (digits.size() % 2 != 0 || !isValidLength(frame.fd, length)) {
    return fail("the data " + excerpt(digits) + " are not two digits a byte, of a length that a frame has");
  }
  frame.length = static_cast<std::uint8_t>(length);
  for (std::size_t i = 0; i < length; ++i) {
    const auto byte = number(digits.substr(2 * i, 2));
    if (!byte) return fail("the data " + excerpt(digits) + " are not hexadecimal");
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return {};
}

Result<AddressedFrame> parseLine(std::string_view line) {
  const auto space = line.find(' ');
  if (space == std::string_view::npos || space == 0 || space >= IFNAMSIZ) {
    return fail("does not begin with an interface and a space: " + excerpt(line));
  }
  auto frame = parseFrameText(line.substr(space + 1));
  if (!frame) return tl::unexpected(frame.error());
  return AddressedFrame{std::string{line.substr(0, space)}, *frame};
}

}  // namespace

std::string frameText(const CanFrame& frame) {
  std::string text = hexDigits(frame.id.value, frame.id.extended ? kExtendedDigits : kStandardDigits) + "#";
  if (frame.fd) text += '#' + hexDigits(frame.bit_rate_switch ? kBitRateSwitch : 0, 1);
  for (const std::uint8_t byte : frame.payload()) text += hexDigits(byte, 2);
  return text;
}

Result<CanFrame> parseFrameText(std::string_view text) {
  const auto hash = text.find('#');
  if (hash == std::string_view::npos) return fail("is no frame such as 200#0011: " + excerpt(text));
  const auto id = parseId(text.substr(0, hash));
  if (!id) return tl::unexpected(id.error());
  CanFrame frame;
  frame.id = *id;
  auto rest = text.substr(hash + 1);
  if (rest.substr(0, 1) == "#") {
    const auto flags = rest.size() > 1 ? digit(rest[1]) : std::nullopt;
    if (!flags || *flags > kBitRateSwitch) return fail("has unknown FD flags: " + excerpt(text));
    frame.fd = true;
    frame.bit_rate_switch = *flags == kBitRateSwitch;
    rest.remove_prefix(2);
  }
  if (auto payload = parsePayload(rest, frame); !payload) return tl::unexpected(payload.error());
  return frame;
}

std::string idText(CanId id) {
  return id.extended ? "0x" + hexDigits(id.value, kExtendedDigits) + " (extended)"
                     : "0x" + hexDigits(id.value, kStandardDigits);
}

std::string frameListText(const std::vector<AddressedFrame>& frames) {
  std::string text;
  for (const auto& [interface, frame] : frames) text += interface + " " + frameText(frame) + "\n";
  return text;
}

Result<std::vector<AddressedFrame>> parseFrameList(std::string_view text) {
  std::vector<AddressedFrame> frames;
  for (int number = 1; !text.empty(); ++number) {
    const auto end = std::min(text.find('\n'), text.size());
    const auto line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.front() == '#') continue;
    auto frame = parseLine(line);
    if (!frame) return fail("line " + std::to_string(number) + ": " + frame.error().message);
    frames.push_back(std::move(*frame));
  }
  return frames;
}

}  // namespace rc10
