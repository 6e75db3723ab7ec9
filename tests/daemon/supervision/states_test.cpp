#include "daemon/supervision/states.hpp"

#include <gtest/gtest.h>

namespace rc10::states_test {
namespace {

constexpr std::array kAllStatus{MotorStatus::kOffline, MotorStatus::kReady, MotorStatus::kEnabling,
                                MotorStatus::kActive, MotorStatus::kFault};
constexpr std::array kAllEvents{MotorEvent::kFeedbackFresh, MotorEvent::kFeedbackLost, MotorEvent::kEnable,
                                MotorEvent::kEnableDone,    MotorEvent::kEnableFailed, MotorEvent::kDisable,
                                MotorEvent::kEstop,         MotorEvent::kFault,        MotorEvent::kClear,
                                MotorEvent::kGroupStop};
static_assert(kAllStatus.size() == kMotorStatusCount);
static_assert(kAllEvents.size() == kMotorEventCount);

// The rules in words, independent of the table: every pair is checked against them.
MotorStatus expected(MotorStatus status, MotorEvent event) {
  using enum MotorStatus;
  if (status == kFault) return event == MotorEvent::kClear ? kOffline : kFault;
  if (event == MotorEvent::kFault) return kFault;
  if (event == MotorEvent::kFeedbackLost) return kOffline;
  if (status == kOffline) return event == MotorEvent::kFeedbackFresh ? kReady : kOffline;
  if (event == MotorEvent::kDisable || event == MotorEvent::kEstop || event == MotorEvent::kGroupStop)
    return kReady;
  if (status == kReady && event == MotorEvent::kEnable) return kEnabling;
  if (event == MotorEvent::kEnableFailed) return kReady;
  if (status == kEnabling && event == MotorEvent::kEnableDone) return kActive;
  return status;
}

TEST(MotorStates, EveryPairOfStatusAndEventFollowsTheRules) {
  for (const auto status : kAllStatus) {
    for (const auto event : kAllEvents) {
      EXPECT_EQ(next(status, event), expected(status, event))
          << toString(status) << " on event " << static_cast<int>(event);
    }
  }
}

TEST(MotorStates, OnlyAnAnsweredEnableSequenceLeadsToActive) {
  for (const auto status : kAllStatus) {
    for (const auto event : kAllEvents) {
      if (status == MotorStatus::kActive || next(status, event) != MotorStatus::kActive) continue;
      EXPECT_EQ(status, MotorStatus::kEnabling);
      EXPECT_EQ(event, MotorEvent::kEnableDone);
    }
  }
}

TEST(MotorStates, TreatsAnUnknownStatusAsAFault) {
  EXPECT_EQ(next(static_cast<MotorStatus>(200), MotorEvent::kEnable), MotorStatus::kFault);
  EXPECT_EQ(next(MotorStatus::kActive, static_cast<MotorEvent>(200)), MotorStatus::kFault);
}

}  // namespace
}  // namespace rc10::states_test
