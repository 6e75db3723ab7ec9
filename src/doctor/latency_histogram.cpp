#include "doctor/latency_histogram.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace rc10::doctor {
namespace {

constexpr std::array<std::int64_t, 12> kEdgesUs{5,   10,   20,   50,   100,    200,
                                                500, 1000, 2000, 5000, 10'000, 20'000};
constexpr double kBarWidth = 40.0;

}  // namespace

void LatencyHistogram::record(Duration late) noexcept {
  late = std::max(late, Duration{0});
  // Rounded up: a row must not promise more than was measured.
  const auto us = std::chrono::ceil<std::chrono::microseconds>(late).count();
  ++bins_[std::min(static_cast<std::size_t>(us), kBins - 1)];
  ++count_;
  max_ = std::max(max_, late);
}

Duration LatencyHistogram::percentile(double share) const noexcept {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t us = 0; us < bins_.size(); ++us) {
    seen += bins_[us];
    if (seen >= wanted) return std::min<Duration>(std::chrono::microseconds{us}, max_);
  }
  return max_;
}

std::vector<LatencyHistogram::Row> LatencyHistogram::rows() const {
  std::vector<Row> rows;
  std::size_t us = 0;
  for (const auto edge : kEdgesUs) {
    Row row{edge, 0};
    for (; us <= static_cast<std::size_t>(edge) && us < bins_.size() - 1; ++us) row.count += bins_[us];
    rows.push_back(row);
  }
  rows.push_back({0, bins_.back()});
  while (!rows.empty() && rows.back().count == 0) rows.pop_back();
  return rows;
}

std::string text(const LatencyHistogram& histogram) {
  std::string text;
  for (const auto& row : histogram.rows()) {
    const double share =
        static_cast<double>(row.count) / static_cast<double>(std::max<std::uint64_t>(histogram.count(), 1));
    // One mark at least for any count.
    const auto marks = static_cast<std::size_t>(std::ceil(share * kBarWidth));
    std::array<char, 64> head{};
    if (row.up_to_us != 0)
      std::snprintf(head.data(), head.size(), "  <= %5lld us %9llu  ", static_cast<long long>(row.up_to_us),
                    static_cast<unsigned long long>(row.count));
    else
      std::snprintf(head.data(), head.size(), "     longer    %9llu  ",
                    static_cast<unsigned long long>(row.count));
    text += head.data() + std::string(marks, '#') + "\n";
  }
  return text;
}

}  // namespace rc10::doctor
