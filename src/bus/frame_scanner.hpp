#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/i_protocol.hpp"

namespace rc10 {

/// Verdict of a protocol on the next bytes.
enum class ScanVerdict : std::uint8_t {
  kMore,         ///< The beginning of a frame: more bytes are needed.
  kFrame,        ///< A frame, which the protocol has taken: as long as what it was shown.
  kSkip,         ///< A whole frame that does not count; all of it is noise.
  kNoise,        ///< No frame begins at the first byte.
  kBadChecksum,  ///< A frame but for its checksum. The bytes behind its first may still be one.
};

/// Finds the frames in a stream of bytes, however it is cut. `Longest`: bytes of the longest frame.
template <std::size_t Longest>
class FrameScanner {
 public:
  /// Asks `judge(std::span<const std::uint8_t>)` for a verdict on what has come since the last frame: after
  /// each byte, and again from each later byte after noise. It is shown at least 1 and at most `Longest`
  /// bytes; kMore on `Longest` bytes counts as kNoise.
  template <typename Judge>
  void scan(std::span<const std::uint8_t> bytes, ProtocolCounters& counters, Judge&& judge) noexcept {
    for (const std::uint8_t byte : bytes) {
      buffer_[size_++] = byte;
      // Only what is new can complete a frame, until noise at the front makes all of it new.
      for (std::size_t shown = size_; shown <= size_ && size_ > 0; ++shown) {
        const ScanVerdict verdict = judge(std::span<const std::uint8_t>(buffer_.data(), shown));
        if (verdict == ScanVerdict::kMore && shown < Longest) continue;
        if (verdict == ScanVerdict::kFrame) ++counters.frames;
        if (verdict == ScanVerdict::kBadChecksum) ++counters.checksum_errors;
        const bool whole = verdict == ScanVerdict::kFrame || verdict == ScanVerdict::kSkip;
        const std::size_t dropped = whole ? shown : 1;
        if (verdict != ScanVerdict::kFrame) counters.resync_bytes += dropped;
        drop(dropped);
        shown = 0;
      }
    }
  }

  /// Forgets what has come since the last frame; it counts as noise.
  void clear(ProtocolCounters& counters) noexcept {
    counters.resync_bytes += size_;
    size_ = 0;
  }

  /// Bytes that have come since the last frame.
  [[nodiscard]] std::size_t pending() const noexcept { return size_; }

 private:
  void drop(std::size_t count) noexcept {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(count),
              buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
    size_ -= count;
  }

  std::array<std::uint8_t, Longest> buffer_{};
  std::size_t size_ = 0;
};

}  // namespace rc10
