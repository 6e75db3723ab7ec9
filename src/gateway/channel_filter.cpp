#include "gateway/channel_filter.hpp"

#include <cstdint>
#include <string_view>

#include "gateway/udpm_datagram.hpp"

namespace rc10::gateway {
namespace {

constexpr std::uint32_t kUdpHeader = 8;  // the filter sees it in front of the datagram
constexpr std::uint32_t kFragmentNumber = kUdpHeader + 16;
constexpr std::uint32_t kAccept = 0xFFFFFFFF;

sock_filter statement(unsigned code, std::uint32_t k) noexcept {
  return sock_filter{static_cast<std::uint16_t>(code), 0, 0, k};
}

sock_filter jumpIfEqual(std::uint32_t k, std::size_t if_true, std::size_t if_false) noexcept {
  return sock_filter{BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(if_true),
                     static_cast<std::uint8_t>(if_false), k};
}

// Accepts if the bytes at `offset` are `text`; else goes on behind. Compares up to four at a time.
void acceptIfText(std::vector<sock_filter>& program, std::uint32_t offset, std::string_view text) {
  std::vector<sock_filter> part;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t left = text.size() - at;
    const std::size_t size = left >= 4 ? 4 : left >= 2 ? 2 : 1;
    const unsigned width = size == 4 ? BPF_W : size == 2 ? BPF_H : BPF_B;
    std::uint32_t expected = 0;
    for (const char c : text.substr(at, size)) expected = (expected << 8U) | static_cast<unsigned char>(c);
    part.push_back(statement(BPF_LD | width | BPF_ABS, offset + static_cast<std::uint32_t>(at)));
    part.push_back(jumpIfEqual(expected, 0, 0));
    at += size;
  }
  part.push_back(statement(BPF_RET | BPF_K, kAccept));
  for (std::size_t i = 1; i + 1 < part.size(); i += 2)
    part[i].jf = static_cast<std::uint8_t>(part.size() - i - 1);
  program.insert(program.end(), part.begin(), part.end());
}

std::vector<sock_filter> anyOf(const std::vector<std::string>& channels, std::size_t header_size) {
  std::vector<sock_filter> program;
  for (const auto& channel : channels) {
    // The terminator belongs to it: "hero.v1.command2" is another channel.
    acceptIfText(program, kUdpHeader + static_cast<std::uint32_t>(header_size),
                 std::string_view{channel.c_str(), channel.size() + 1});
  }
  program.push_back(statement(BPF_RET | BPF_K, 0));
  return program;
}

}  // namespace

std::vector<sock_filter> channelFilter(const std::vector<std::string>& channels) {
  const auto whole = anyOf(channels, kShortHeaderSize);
  const auto fragment = anyOf(channels, kLongHeaderSize);
  std::vector<sock_filter> program;
  program.push_back(statement(BPF_LD | BPF_W | BPF_ABS, kUdpHeader));
  program.push_back(jumpIfEqual(kMagicLong, 0, 3));
  program.push_back(statement(BPF_LD | BPF_H | BPF_ABS, kFragmentNumber));
  program.push_back(jumpIfEqual(0, 3, 0));
  program.push_back(statement(BPF_RET | BPF_K, 0));
  program.push_back(jumpIfEqual(kMagicShort, 1, 0));
  program.push_back(statement(BPF_RET | BPF_K, 0));
  // Here: the first fragment, or a whole message. Told apart once more, as jumps reach only 255 far.
  program.push_back(statement(BPF_LD | BPF_W | BPF_ABS, kUdpHeader));
  program.push_back(jumpIfEqual(kMagicShort, 1, 0));
  program.push_back(statement(BPF_JMP | BPF_JA, static_cast<std::uint32_t>(whole.size())));
  program.insert(program.end(), whole.begin(), whole.end());
  program.insert(program.end(), fragment.begin(), fragment.end());
  return program;
}

}  // namespace rc10::gateway
