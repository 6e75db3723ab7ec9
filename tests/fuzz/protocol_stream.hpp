#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "bus/i_protocol.hpp"

namespace rc10::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

/// A copy on the heap of exactly this size: a read past its end is found.
class ExactBytes {
 public:
  explicit ExactBytes(std::span<const std::uint8_t> bytes)
      : bytes_(new std::uint8_t[bytes.size()]), size_(bytes.size()) {
    std::copy(bytes.begin(), bytes.end(), bytes_.get());
  }
  [[nodiscard]] std::span<const std::uint8_t> span() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t size_;
};

inline void requireSame(const ProtocolCounters& a, const ProtocolCounters& b) {
  require(a.frames == b.frames && a.checksum_errors == b.checksum_errors && a.resync_bytes == b.resync_bytes);
}

/// The first bytes cut the rest into pieces. Whatever the bytes and the cuts: nothing is read past a piece,
/// and the pieces make what the whole makes. `longest`: bytes of the longest frame. `check(protocol)` looks
/// at the values.
template <typename Make, typename Check>
void streamOf(std::span<const std::uint8_t> input, std::size_t longest, const Make& make,
              const Check& check) {
  constexpr std::size_t kCuts = 8;
  if (input.size() < kCuts) return;
  const auto cuts = input.first(kCuts);
  const auto stream = input.subspan(kCuts);

  const auto whole = make();
  whole->parse_stream(ExactBytes(stream).span(), MonotonicTime{std::chrono::hours{1}});
  check(*whole);
  // Every byte is part of a frame, noise, or waits for more.
  const auto& counters = whole->counters();
  require(counters.resync_bytes <= stream.size());
  require(counters.frames * longest + counters.resync_bytes + longest >= stream.size());

  const auto pieces = make();
  std::size_t at = 0;
  for (std::size_t cut = 0; at < stream.size(); ++cut) {
    const auto size = std::min<std::size_t>(1U + cuts[cut % kCuts], stream.size() - at);
    pieces->parse_stream(ExactBytes(stream.subspan(at, size)).span(), MonotonicTime{std::chrono::hours{1}});
    at += size;
  }
  check(*pieces);
  requireSame(pieces->counters(), whole->counters());

  // Silences, restarts and empty pieces between them.
  const auto gaps = make();
  MonotonicTime now{std::chrono::hours{1}};
  at = 0;
  for (std::size_t cut = 0; at < stream.size(); ++cut) {
    const auto size = std::min<std::size_t>(cuts[cut % kCuts] % 32U, stream.size() - at);
    gaps->parse_stream(ExactBytes(stream.subspan(at, size)).span(), now);
    now += std::chrono::milliseconds{cuts[cut % kCuts] % 5U};
    if (size == 0) {
      gaps->restart();
      ++at;
    }
    at += size;
  }
  check(*gaps);
}

/// Packed bytes fit, whatever the room.
template <typename Make>
void roundTrip(std::span<const std::uint8_t> payload, const Make& make) {
  const auto protocol = make();
  std::array<std::uint8_t, 512> room;
  const std::size_t size = protocol->pack_frame(ExactBytes(payload).span(), room);
  require(size <= room.size());
  if (size == 0) return;
  std::vector<std::uint8_t> exact(size);
  require(protocol->pack_frame(payload, exact) == size);
  require(std::equal(exact.begin(), exact.end(), room.begin()));
  std::vector<std::uint8_t> too_short(size - 1);
  require(protocol->pack_frame(payload, too_short) == 0);
}

}  // namespace rc10::fuzz
