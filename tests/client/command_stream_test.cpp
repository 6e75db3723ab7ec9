#include "client/command_stream.hpp"

#include <string_view>

#include <gmock/gmock.h>

#include "app/event_code.hpp"

namespace rc10::client::test::command_stream_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr Duration kPeriod = 20ms;

link::Event event(EventCode code, std::string_view source, std::string_view text) {
  link::Event out;
  out.code = static_cast<std::int32_t>(code);
  out.source = source;
  out.text = text;
  return out;
}

class CommandStreamTest : public ::testing::Test {
 protected:
  /// A turn of its program that has read a state of this age; whether it has sent.
  bool turn(Duration age = 1ms) {
    const auto newest = std::chrono::duration_cast<std::chrono::microseconds>((now - age).time_since_epoch());
    if (!stream.due(now, newest.count())) return false;
    stream.sent(now);
    return true;
  }
  void hear(EventCode code, std::string_view source, std::string_view text) {
    stream.hear(event(code, source, text));
  }
  std::string ended() { return stream.ended(now); }

  MonotonicTime now{1000s};
  CommandStream stream{{"left", "right"}, kPeriod};
};

TEST_F(CommandStreamTest, OneIsDueInEachPeriodAndTheFirstAtOnce) {
  std::string sent;
  for (int ms = 0; ms < 50; ms += 5, now += 5ms) sent += turn() ? '1' : '0';
  EXPECT_EQ(sent, "1000100010");
}

TEST_F(CommandStreamTest, AMotorOfItThatLeavesActiveEndsItForGood) {
  for (const auto* change : {"ACTIVE -> READY (disabled by 'panel')", "ENABLING -> FAULT"}) {
    stream = CommandStream{{"left", "right"}, kPeriod};
    EXPECT_TRUE(turn());
    hear(EventCode::kMotorStatus, "right", change);
    hear(EventCode::kMotorStatus, "right", "READY -> ENABLING");
    hear(EventCode::kMotorStatus, "right", "ENABLING -> ACTIVE");
    EXPECT_EQ(ended(), std::string{"motor 'right': "} + change);
  }
}

TEST_F(CommandStreamTest, ARobotThatLeavesRunEndsItForGoodAlsoWithoutMotors) {
  for (const auto* change : {"RUN -> ESTOP (asked for by 'panel')", "RUN -> STOPPING"}) {
    stream = CommandStream{{}, kPeriod};
    EXPECT_TRUE(turn());
    hear(EventCode::kRobotState, "robot", change);
    hear(EventCode::kRobotState, "robot", "ESTOP -> RUN");
    EXPECT_THAT(ended(), HasSubstr(change));
    EXPECT_THAT(ended(), HasSubstr("`rc10ctl clear`"));
  }
}

TEST_F(CommandStreamTest, OtherMotorsOtherChangesAndWhatWasBeforeEndNothing) {
  hear(EventCode::kMotorStatus, "left", "ACTIVE -> READY");
  EXPECT_TRUE(turn());
  hear(EventCode::kMotorStatus, "lift", "ACTIVE -> READY");
  hear(EventCode::kMotorStatus, "left", "ENABLING -> ACTIVE");
  hear(EventCode::kMotorFault, "left", "ACTIVE -> READY");
  hear(EventCode::kRobotState, "robot", "ESTOP -> RUN");
  EXPECT_EQ(ended(), "");
}

TEST_F(CommandStreamTest, AfterAPauseNothingIsSentBeforeAYoungerStateWasRead) {
  EXPECT_TRUE(turn());
  now += 300ms;
  EXPECT_EQ(ended(), "");
  EXPECT_FALSE(turn());
  now += kPeriod;
  EXPECT_FALSE(turn(kPeriod + 1ms));
  now += kPeriod;
  EXPECT_TRUE(turn());
}

TEST_F(CommandStreamTest, AStopThatIsReadAfterAPauseComesBeforeTheNextSending) {
  EXPECT_TRUE(turn());
  now += 300ms;
  hear(EventCode::kMotorStatus, "left", "ACTIVE -> READY");
  hear(EventCode::kMotorStatus, "left", "ENABLING -> ACTIVE");
  EXPECT_THAT(ended(), HasSubstr("motor 'left'"));
}

TEST_F(CommandStreamTest, ALongPauseEndsIt) {
  EXPECT_TRUE(turn());
  now += CommandStream::kLongestPause;
  EXPECT_EQ(ended(), "");
  now += 1ms;
  EXPECT_THAT(ended(), HasSubstr("held up for more than 2 s"));
}

}  // namespace
}  // namespace rc10::client::test::command_stream_test
