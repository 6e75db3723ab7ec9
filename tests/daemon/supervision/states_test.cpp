#include "daemon/supervision/states.hpp"

#include <gtest/gtest.h>

namespace rc10::states_test {
namespace {

constexpr std::array kAllStatus{MotorStatus::kOffline, MotorStatus::kReady, MotorStatus::kEnabling,
                                MotorStatus::kActive, MotorStatus::kFault};
constexpr std::array kAllEvents{MotorEvent::kFeedbackFresh, MotorEvent::kFeedbackLost,  MotorEvent::kEnable,
                                MotorEvent::kEnableDone,    MotorEvent::kEnableFailed,  MotorEvent::kDisable,
                                MotorEvent::kEstop,         MotorEvent::kFault,         MotorEvent::kClear,
                                MotorEvent::kGroupStop,     MotorEvent::kDisableUnasked};
static_assert(kAllStatus.size() == kMotorStatusCount);
static_assert(kAllEvents.size() == kMotorEventCount);

// The rules in words, independent of the table: every pair is checked against them.
MotorStatus expected(MotorStatus status, MotorEvent event) {
  using enum MotorStatus;
  if (status == kFault) return event == MotorEvent::kClear ? kOffline : kFault;
  if (event == MotorEvent::kFault) return kFault;
  if (event == MotorEvent::kFeedbackLost) return kOffline;
  if (status == kOffline) return event == MotorEvent::kFeedbackFresh ? kReady : kOffline;
  if (isDisable(event) || event == MotorEvent::kEstop || event == MotorEvent::kGroupStop) return kReady;
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

TEST(MotorStates, IsOnFromItsEnablingToItsRest) {
  for (const auto status : kAllStatus)
    EXPECT_EQ(isOn(status), status == MotorStatus::kEnabling || status == MotorStatus::kActive);
}

TEST(MotorStates, EachStopHasItsCause) {
  using enum MotorEvent;
  for (const auto robot : {RobotStatus::kRun, RobotStatus::kEstop, RobotStatus::kStopping}) {
    EXPECT_EQ(causeOf(kFeedbackLost, robot), StopCause::kSilence);
    EXPECT_EQ(causeOf(kEnableFailed, robot), StopCause::kRefused);
    EXPECT_EQ(causeOf(kDisable, robot), StopCause::kRequest);
    EXPECT_EQ(causeOf(kFault, robot), StopCause::kFault);
    EXPECT_EQ(causeOf(kGroupStop, robot), StopCause::kGroup);
    EXPECT_EQ(causeOf(kEstop, robot),
              robot == RobotStatus::kStopping ? StopCause::kShutdown : StopCause::kEstop);
    for (const auto event : {kFeedbackFresh, kEnable, kEnableDone, kClear})
      EXPECT_EQ(causeOf(event, robot), StopCause::kNone);
  }
}

TEST(MotorStates, TreatsAnUnknownStatusAsAFault) {
  for (const int beyond : {0, 1, 200}) {
    EXPECT_EQ(next(static_cast<MotorStatus>(kMotorStatusCount + beyond), MotorEvent::kEnable),
              MotorStatus::kFault);
    EXPECT_EQ(next(MotorStatus::kActive, static_cast<MotorEvent>(kMotorEventCount + beyond)),
              MotorStatus::kFault);
  }
}

}  // namespace
}  // namespace rc10::states_test
