#include "daemon/exchange/events.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>

#include "app/target.hpp"
#include "app/vocabulary.hpp"
#include "bus/bus_health.hpp"

namespace rc10::test::events_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::array kCodes{
    EventCode::kMotorStatus,     EventCode::kCommandTimeout,  EventCode::kReferenceLost,
    EventCode::kSetpointSkipped, EventCode::kNotOwner,        EventCode::kMotorFault,
    EventCode::kGroupStopped,    EventCode::kGroupRearmed,    EventCode::kModule,
    EventCode::kModuleRefused,   EventCode::kGainChanged,     EventCode::kRobotState,
    EventCode::kTicksMissed,     EventCode::kCommandRefused,  EventCode::kEstopInput,
    EventCode::kBusState,        EventCode::kBusAdvice,       EventCode::kForeignSender,
    EventCode::kSerialPort,      EventCode::kDevice,          EventCode::kMovesAtRest,
    EventCode::kNeverHeard,      EventCode::kFallbackReplaced};

template <typename Value, typename Extra = int>
std::string words(EventCode code, Value value, Extra extra = {}) {
  Event event;
  event.code = code;
  event.value = static_cast<std::int32_t>(value);
  event.extra = static_cast<std::int32_t>(extra);
  return describe(event);
}

TEST(Events, EveryCodeHasWordsOfItsOwn) {
  std::set<std::string> seen;
  for (const auto code : kCodes) {
    const auto text = words(code, 1, 2);
    EXPECT_THAT(text, Not(StartsWith("event "))) << static_cast<int>(code);
    EXPECT_GT(text.size(), 5U);
    seen.insert(text);
  }
  EXPECT_EQ(seen.size(), kCodes.size());
}

TEST(Events, TheNumbersAreThoseOfTheContract) {
  constexpr std::array kNumbers{100, 101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 200,
                                201, 202, 203, 300, 301, 302, 310, 311, 111, 112, 113};
  static_assert(kNumbers.size() == kCodes.size());
  for (std::size_t i = 0; i < kCodes.size(); ++i) EXPECT_EQ(static_cast<int>(kCodes[i]), kNumbers[i]);
}

TEST(Events, AStatusChangeNamesTheOldAndTheNewStatusInThisOrder) {
  EXPECT_EQ(words(EventCode::kMotorStatus, MotorStatus::kActive, MotorStatus::kEnabling),
            "ENABLING -> ACTIVE");
  EXPECT_EQ(words(EventCode::kRobotState, RobotStatus::kEstop, RobotStatus::kRun), "RUN -> ESTOP");
}

TEST(Events, ASkippedSetpointNamesTheModeAndTheStatus) {
  const auto text =
      words(EventCode::kSetpointSkipped, SkipReason::kNotActive,
            256 * static_cast<int>(MotorStatus::kReady) + static_cast<int>(ControlMode::kVelocity));
  EXPECT_THAT(text, HasSubstr("velocity"));
  EXPECT_THAT(text, HasSubstr("READY, not ACTIVE"));
}

TEST(Events, ASetpointSkippedByAnActiveMotorNamesTheMissingReferenceAndTheRemedy) {
  const auto text = words(EventCode::kSetpointSkipped, SkipReason::kNoReference, ControlMode::kTotalAngle);
  EXPECT_THAT(text, HasSubstr("total_angle"));
  EXPECT_THAT(text, HasSubstr("zero: power_on"));
}

TEST(Events, MissedTicksAreNumbered) {
  EXPECT_EQ(words(EventCode::kTicksMissed, 12), "12 ticks missed");
  EXPECT_EQ(words(EventCode::kTicksMissed, 1), "1 tick missed");
}

TEST(Events, EveryBusStateHasWordsOfItsOwn) {
  std::set<std::string> seen;
  for (int state = 0; state <= static_cast<int>(BusState::kStalled); ++state) {
    const auto text = words(EventCode::kBusState, state, BusState::kActive);
    EXPECT_THAT(text, HasSubstr("(was active)"));
    EXPECT_THAT(text, Not(HasSubstr("unknown")));
    seen.insert(text);
  }
  EXPECT_EQ(seen.size(), 8U);
}

TEST(Events, NumbersFromNowhereAreStillPrinted) {
  EXPECT_THAT(words(EventCode::kBusState, 99), HasSubstr("unknown"));
  EXPECT_EQ(words(EventCode{999}, 0), "event 999");
}

}  // namespace
}  // namespace rc10::test::events_test
