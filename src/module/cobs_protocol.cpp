#include "module/cobs_protocol.hpp"

#include <algorithm>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"

namespace rc10 {
namespace {

constexpr std::uint8_t kDelimiter = 0;
constexpr std::uint8_t kLongestBlock = 0xFF;  // 254 bytes, and no 0 behind them
constexpr std::size_t kCrcBytes = 2;

// In place: each block's first byte tells where the next one begins. 0: the bytes are no stuffed frame.
[[nodiscard]] std::size_t unstuff(std::span<std::uint8_t> bytes) noexcept {
  std::size_t out = 0;
  std::size_t in = 0;
  while (in < bytes.size()) {
    const std::uint8_t code = bytes[in++];
    const std::size_t length = code - 1U;
    if (code == kDelimiter || in + length > bytes.size()) return 0;
    for (std::size_t i = 0; i < length; ++i) bytes[out++] = bytes[in++];
    if (code != kLongestBlock && in < bytes.size()) bytes[out++] = kDelimiter;
  }
  return out;
}

}  // namespace

void CobsProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  for (const std::uint8_t byte : bytes) {
    if (byte == kDelimiter) {
      take(received);
    } else if (size_ == buffer_.size()) {
      too_long_ = true;
      ++counters_.resync_bytes;
    } else {
      buffer_[size_++] = byte;
    }
  }
}

void CobsProtocol::take(MonotonicTime received) noexcept {
  const std::size_t stuffed = size_;
  const bool too_long = too_long_;
  const bool from_its_start = seen_delimiter_;
  size_ = 0;
  too_long_ = false;
  seen_delimiter_ = true;
  if (stuffed == 0) {  // a zero between frames
    ++counters_.resync_bytes;
    return;
  }
  const std::size_t size = too_long ? 0 : unstuff(std::span{buffer_}.first(stuffed));
  if (size <= kCrcBytes) {
    counters_.resync_bytes += stuffed + 1;
    return;
  }
  const auto content = std::span<const std::uint8_t>{buffer_}.first(size - kCrcBytes);
  if (crc16Modbus(content) != readLittleEndian<std::uint16_t>(buffer_, content.size())) {
    if (from_its_start) ++counters_.checksum_errors;
    counters_.resync_bytes += stuffed + 1;
    return;
  }
  ++counters_.frames;
  listener_.onFrame(content, received);
}

std::size_t CobsProtocol::pack_frame(std::span<const std::uint8_t> payload,
                                     std::span<std::uint8_t> out) const noexcept {
  if (payload.empty() || payload.size() > kLongestContent) return 0;
  std::array<std::uint8_t, kLongestContent + kCrcBytes> plain{};
  std::copy(payload.begin(), payload.end(), plain.begin());
  writeLittleEndian(plain, payload.size(), crc16Modbus(payload));
  const auto bytes = std::span{plain}.first(payload.size() + kCrcBytes);
  // Shorter than a longest block: one byte more in front, and the 0.
  static_assert(plain.size() < kLongestBlock - 1U);
  if (out.size() < bytes.size() + 2) return 0;
  std::size_t code_at = 0;
  std::size_t at = 1;
  for (const std::uint8_t byte : bytes) {
    if (byte != kDelimiter) {
      out[at++] = byte;
      continue;
    }
    out[code_at] = static_cast<std::uint8_t>(at - code_at);
    code_at = at++;
  }
  out[code_at] = static_cast<std::uint8_t>(at - code_at);
  out[at++] = kDelimiter;
  return at;
}

void CobsProtocol::restart() noexcept {
  counters_.resync_bytes += size_;
  size_ = 0;
  too_long_ = false;
  seen_delimiter_ = false;
}

}  // namespace rc10
