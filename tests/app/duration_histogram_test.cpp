#include "app/duration_histogram.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rc10::duration_histogram_test {
namespace {

using namespace std::chrono_literals;
using Histogram = BasicDurationHistogram<PlainCount>;

TEST(DurationHistogram, IsZeroWithoutRecords) {
  const Histogram histogram;
  EXPECT_EQ(histogram.percentile(0.99), 0ns);
  EXPECT_EQ(histogram.count(), 0U);
}

TEST(DurationHistogram, PercentilesAreRightToASixteenth) {
  Histogram histogram;
  std::vector<std::int64_t> values;
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> latency(10.0, 2.0);
  for (int i = 0; i < 100'000; ++i) {
    values.push_back(static_cast<std::int64_t>(latency(random)));
    histogram.record(Duration{values.back()});
  }
  std::sort(values.begin(), values.end());
  for (const double fraction : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto exact = static_cast<double>(values[static_cast<std::size_t>(fraction * 100'000) - 1]);
    const auto found = static_cast<double>(histogram.percentile(fraction).count());
    EXPECT_GE(found, exact);
    EXPECT_LE(found, exact * (1.0 + 1.0 / 16.0) + 1.0);
  }
  EXPECT_EQ(histogram.max().count(), values.back());
  EXPECT_EQ(histogram.percentile(1.0).count(), values.back());
}

TEST(DurationHistogram, TheSumOfTwoHasTheRecordsOfBoth) {
  Histogram sum;
  Histogram other;
  for (int i = 0; i < 30; ++i) sum.record(std::chrono::microseconds{10});
  for (int i = 0; i < 10; ++i) other.record(std::chrono::microseconds{1000});
  sum.add(other);
  EXPECT_EQ(sum.count(), 40U);
  EXPECT_LT(sum.percentile(0.7), std::chrono::microseconds{12});
  EXPECT_GT(sum.percentile(0.8), std::chrono::microseconds{900});
  EXPECT_EQ(sum.max(), std::chrono::microseconds{1000});
}

TEST(DurationHistogram, TakesNegativeAndEnormousDurations) {
  Histogram histogram;
  histogram.record(-5ns);
  histogram.record(1h);
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_EQ(histogram.percentile(0.1), 0ns);
  EXPECT_EQ(histogram.max(), 1h);
}

TEST(DurationHistogram, CountsUpToALimitWhatIsSurelyNotAboveIt) {
  Histogram histogram;
  for (int us = 1; us <= 100; ++us) histogram.record(std::chrono::microseconds{us});
  histogram.record(1h);
  EXPECT_LE(histogram.countUpTo(50us), 50U);
  EXPECT_GE(histogram.countUpTo(50us), 46U);
  EXPECT_EQ(histogram.countUpTo(10ms), 100U);
  EXPECT_EQ(histogram.countUpTo(2h), 100U);
}

}  // namespace
}  // namespace rc10::duration_histogram_test
