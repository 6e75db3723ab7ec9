#include "daemon/recording/copy_plan.hpp"

#include <gtest/gtest.h>

#include <string>

namespace rc10::test::copy_plan_test {
namespace {

using namespace std::chrono_literals;

constexpr auto kFault = static_cast<std::uint32_t>(CopyCause::kFault);
constexpr auto kEstop = static_cast<std::uint32_t>(CopyCause::kEstop);
constexpr MonotonicTime kStart{1000s};

std::string text(const char* cause) { return cause != nullptr ? cause : ""; }

TEST(CopyPlan, ACopyIsMadeOneSecondAfterItsCauseSoThatWhatFollowedIsInIt) {
  CopyPlan plan;
  plan.note(kEstop, kStart);
  EXPECT_EQ(text(plan.due(kStart + 999ms)), "");
  EXPECT_EQ(text(plan.due(kStart + 1s)), "estop");
  EXPECT_EQ(text(plan.due(kStart + 100s)), "");
}

TEST(CopyPlan, CausesWithinThatSecondShareACopy) {
  CopyPlan plan;
  plan.note(kFault, kStart);
  plan.note(kEstop, kStart + 100ms);
  EXPECT_EQ(text(plan.due(kStart + 1s)), "fault");
  EXPECT_EQ(text(plan.due(kStart + 100s)), "");
}

TEST(CopyPlan, TheNextWaitsUntilTenSecondsAfterTheLast) {
  CopyPlan plan;
  plan.note(kEstop, kStart);
  EXPECT_EQ(text(plan.due(kStart + 1s)), "estop");
  plan.note(kFault, kStart + 2s);
  EXPECT_EQ(text(plan.due(kStart + 10999ms)), "");
  EXPECT_EQ(text(plan.due(kStart + 11s)), "fault");
}

TEST(CopyPlan, AtTheEndThereIsNoWaiting) {
  CopyPlan plan;
  EXPECT_EQ(text(plan.last(kStart)), "");
  plan.note(kEstop, kStart);
  EXPECT_EQ(text(plan.last(kStart)), "estop");
}

TEST(CopyPlan, WithoutACauseThereIsNone) {
  CopyPlan plan;
  plan.note(0, kStart);
  EXPECT_EQ(text(plan.due(kStart + 100s)), "");
}

}  // namespace
}  // namespace rc10::test::copy_plan_test
