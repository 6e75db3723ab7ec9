#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/myactuator_bench.hpp"

namespace rc10::test::myactuator_enabling_test {
namespace {

using namespace myactuator_bench;

TEST_F(MyActuatorMotor, EnablingChecksErrorsAndRunTimeAndThatItObeysWithoutTorque) {
  comeOnline();
  motor_.order(FrameKind::kEnable);
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kPending);
  const std::string off = "141#8000000000000000";  // it may be following an older command
  EXPECT_THAT(tick(), ::testing::IsSupersetOf({off, std::string{"141#9A00000000000000"}}));
  hear(frameOf("241#9A1E0000E0010000"));
  EXPECT_THAT(tick(), ::testing::IsSupersetOf({off, std::string{"141#B100000000000000"}}));
  hear(uptimeReply(uptime_ms_ + 2));
  EXPECT_EQ(tick().at(0), "141#A100000000000000");
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kPending);
  hear(frameOf("241#A11E000000000A00"));
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kDone);
  EXPECT_EQ(tick().at(0), "141#A100000000000000");
}

TEST_F(MyActuatorMotor, EnablingReleasesTheBrakeOnlyIfTheConfigurationSaysSo) {
  MotorSettings settings = settingsOf();
  settings.own.set("release_brake", 1.0);
  MyActuator_Motor braked = motorOf(settings);
  braked.order(FrameKind::kEnable);
  std::array<CanFrame, 4> out{};
  const auto next = [&] {
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    braked.update(tick);
    (void)braked.packCommand(tick, out);
    return textOf(out[0]);
  };
  const auto say = [&](CanFrame frame) {
    frame.received = now_;
    (void)braked.updateFeedback(frame);
  };
  (void)next();
  say(frameOf("241#9A1E0000E0010000"));
  (void)next();
  say(uptimeReply(1000));
  EXPECT_EQ(next(), "141#7700000000000000");
  say(frameOf("241#7700000000000000"));
  EXPECT_EQ(next(), "141#A100000000000000");
}

TEST_F(MyActuatorMotor, AnUnansweredStepIsSentFiveTimesAndThenEnablingHasFailed) {
  motor_.order(FrameKind::kEnable);
  int asked = 0;
  int ms = 0;
  for (; ms < 1000 && motor_.sequenceProgress() == SequenceProgress::kPending; ++ms) {
    const auto sent = tick();
    asked += sent.size() > 1 && sent[1] == "141#9A00000000000000" ? 1 : 0;
    EXPECT_EQ(sent.at(0), "141#8000000000000000") << "output off until it is known to be well";
  }
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_GE(asked, 5);
  EXPECT_GT(ms, 200);
  EXPECT_LT(ms, 300);
  EXPECT_EQ(tick().at(0), "141#8000000000000000") << "output off after a failure";
  motor_.order(FrameKind::kPoll);
  (void)tick();
  motor_.order(FrameKind::kEnable);
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kPending);
  (void)tick();
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kPending) << "a new order starts anew";
}

TEST_F(MyActuatorMotor, EnablingFailsWhileTheDriveHasAnError) {
  comeOnline();
  motor_.order(FrameKind::kEnable);
  (void)tick();
  hear(frameOf("241#9A1E0000E0010200"));
  EXPECT_EQ(motor_.sequenceProgress(), SequenceProgress::kFailed);
}

}  // namespace
}  // namespace rc10::test::myactuator_enabling_test
