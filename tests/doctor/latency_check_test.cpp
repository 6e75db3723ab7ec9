#include "doctor/latency_check.hpp"

#include <gmock/gmock.h>

#include "doctor/report.hpp"

namespace rc10::doctor::latency_check_test {
namespace {

using std::chrono::microseconds;
using ::testing::HasSubstr;

Verdict verdict(microseconds max, bool realtime = true) {
  LatencyFacts facts;
  facts.period = microseconds{1000};
  facts.max = max;
  facts.realtime = realtime;
  return checkLatency(facts).verdict;
}

TEST(LatencyCheck, ATenthOfATickIsGoodHalfATickIsTooMuch) {
  EXPECT_EQ(verdict(microseconds{100}), Verdict::kPass);
  EXPECT_EQ(verdict(microseconds{101}), Verdict::kWarn);
  EXPECT_EQ(verdict(microseconds{500}), Verdict::kWarn);
  EXPECT_EQ(verdict(microseconds{501}), Verdict::kFail);
}

TEST(LatencyCheck, WithoutRealTimePriorityItSaysNothingAboutRc10d) {
  EXPECT_EQ(verdict(microseconds{10}, false), Verdict::kWarn);
  EXPECT_EQ(verdict(microseconds{5000}, false), Verdict::kWarn);
}

TEST(LatencyHistogram, WhatIsBeyondItsRowsIsCountedAndItsMaximumKept) {
  LatencyHistogram histogram;
  histogram.record(microseconds{-5});
  histogram.record(std::chrono::seconds{3});
  EXPECT_EQ(histogram.max(), std::chrono::seconds{3});
  EXPECT_EQ(rows(histogram).front().count, 1U);
  EXPECT_EQ(rows(histogram).back().up_to_us, 0);
  EXPECT_EQ(rows(histogram).back().count, 1U);
}

TEST(LatencyHistogram, RowsHoldEveryRecordOnce) {
  LatencyHistogram histogram;
  for (int us = 0; us < 3000; us += 7) histogram.record(microseconds{us});
  std::uint64_t sum = 0;
  for (const auto& row : rows(histogram)) sum += row.count;
  EXPECT_EQ(sum, histogram.count());
  EXPECT_THAT(text(histogram), HasSubstr("<=  5000 us"));
}

TEST(LatencyHistogram, NoRowPromisesMoreThanWasMeasured) {
  LatencyHistogram histogram;
  histogram.record(std::chrono::nanoseconds{5'001});
  histogram.record(std::chrono::nanoseconds{20'000'001});
  EXPECT_EQ(rows(histogram).front().count, 0U);
  EXPECT_EQ(rows(histogram).back().up_to_us, 0);
}

TEST(LatencyHistogram, AnEmptyOneHasNoRows) { EXPECT_TRUE(rows(LatencyHistogram()).empty()); }

TEST(Report, AFindingIsALineAndItsFixAnother) {
  EXPECT_EQ(text(warn("fan", "off", "turn it on"), false), "warn  fan: off\n      fix: turn it on\n");
  EXPECT_EQ(text(pass("fan", "on"), false), "pass  fan: on\n");
  EXPECT_THAT(text(pass("fan", "on"), true), HasSubstr("\x1b[32mpass\x1b[0m"));
  EXPECT_EQ(json(fault("fan", "off", "x")), R"({"check":"fan","status":"fail","why":"off","fix":"x"})");
  EXPECT_EQ(json(pass("fan", "on")), R"({"check":"fan","status":"pass","why":"on","fix":null})");
  EXPECT_EQ(summary({pass("a", ""), warn("b", "", ""), fault("c", "", ""), pass("d", "")}),
            "2 passed, 1 warned, 1 failed\n");
}

}  // namespace
}  // namespace rc10::doctor::latency_check_test
