#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/time.hpp"

namespace rc10::doctor {

/// Lateness of a thread's wake-ups, in whole microseconds. All memory is there from the beginning: a
/// real-time thread may record.
class LatencyHistogram {
 public:
  LatencyHistogram() : bins_(kBins, 0) {}

  void record(Duration late) noexcept;

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] Duration max() const noexcept { return max_; }
  /// The latency that the given share (0 to 1) of all stays below or at.
  [[nodiscard]] Duration percentile(double share) const noexcept;

  /// A row of the histogram for people: the count at or below this and above the row before.
  struct Row {
    std::int64_t up_to_us = 0;  ///< 0: above all others.
    std::uint64_t count = 0;
  };
  [[nodiscard]] std::vector<Row> rows() const;

 private:
  static constexpr std::size_t kBins = 20'000;  // 20 ms; what is later counts as the last

  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
  Duration max_{0};
};

/// One line a row, with a bar.
[[nodiscard]] std::string text(const LatencyHistogram& histogram);

}  // namespace rc10::doctor
