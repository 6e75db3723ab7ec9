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

std::vector<LatencyRow> rows(const LatencyHistogram& histogram) {
  std::vector<LatencyRow> rows;
  std::uint64_t below = 0;
  for (const auto edge_us : kEdgesUs) {
    const auto up_to = histogram.countUpTo(std::chrono::microseconds{edge_us});
    rows.push_back({edge_us, up_to - below});
    below = up_to;
  }
  rows.push_back({0, histogram.count() - below});
  while (!rows.empty() && rows.back().count == 0) rows.pop_back();
  return rows;
}

std::string text(const LatencyHistogram& histogram) {
  std::string text;
  for (const auto& row : rows(histogram)) {
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
