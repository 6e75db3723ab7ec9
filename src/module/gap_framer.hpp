#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "app/time.hpp"
#include "bus/frame_scanner.hpp"

namespace rc10 {

/// Finds frames of one length that have no checksum, as remote controls send them: by the silence between
/// them and by what may stand in them. After a silence a plausible frame counts. Without one, after garbage,
/// the first plausible frame only shows where frames begin, and counts as noise; the one right behind it
/// counts.
template <std::size_t Length>
class GapFramer {
 public:
  /// `gap`: a silence of at least this ends a frame, whole or not.
  explicit GapFramer(Duration gap) noexcept : gap_(gap) {}

  /// `plausible(frame)` judges, `take(frame)` decodes; a frame is a std::span of `Length` bytes.
  template <typename Plausible, typename Take>
  void parse(std::span<const std::uint8_t> bytes, MonotonicTime received, ProtocolCounters& counters,
             const Plausible& plausible, const Take& take) noexcept {
    if (bytes.empty()) return;
    if (heard_ && received - last_ >= gap_) {
      scanner_.clear(counters);
      aligned_ = true;
    }
    heard_ = true;
    last_ = received;
    scanner_.scan(bytes, counters, [&](std::span<const std::uint8_t> shown) {
      if (shown.size() < Length) return ScanVerdict::kMore;
      const auto frame = shown.template first<Length>();
      const bool was_aligned = aligned_;
      aligned_ = plausible(frame);
      if (!aligned_) return ScanVerdict::kNoise;
      if (!was_aligned) return ScanVerdict::kSkip;
      take(frame);
      return ScanVerdict::kFrame;
    });
  }

  void restart(ProtocolCounters& counters) noexcept {
    scanner_.clear(counters);
    aligned_ = heard_ = false;
  }

 private:
  Duration gap_;
  FrameScanner<Length> scanner_;
  bool aligned_ = false;
  bool heard_ = false;
  MonotonicTime last_;
};

}  // namespace rc10
