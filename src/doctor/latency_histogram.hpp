#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/duration_histogram.hpp"

namespace rc10::doctor {

/// Lateness of a thread's wake-ups. A real-time thread may record.
using LatencyHistogram = BasicDurationHistogram<PlainCount>;

/// A row of the histogram for people: the count at or below this and above the row before. A record of a bin
/// that an edge divides counts above it: no row promises more than was measured.
struct LatencyRow {
  std::int64_t up_to_us = 0;  ///< 0: above all others.
  std::uint64_t count = 0;
};
[[nodiscard]] std::vector<LatencyRow> rows(const LatencyHistogram& histogram);

/// One line a row, with a bar.
[[nodiscard]] std::string text(const LatencyHistogram& histogram);

}  // namespace rc10::doctor
