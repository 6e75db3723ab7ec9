#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/myactuator_bench.hpp"

namespace rc10::test::myactuator_motor_test {
namespace {

using namespace myactuator_bench;

TEST_F(MyActuatorMotor, RestsWithTheOutputOffBeforeItHasHeardAnything) {
  EXPECT_THAT(tick(), ElementsAre("141#8000000000000000"));
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(motor_.packRest(out), 1U);
  EXPECT_EQ(textOf(out[0]), "141#8000000000000000");
}

TEST_F(MyActuatorMotor, PollingTurnsTheOutputOffFirstAndAsksForTheAngleEveryTime) {
  comeOnline();
  motor_.order(FrameKind::kPoll);
  const auto first = tick();
  EXPECT_EQ(first.at(0), kOff);
  EXPECT_THAT(first, Contains("141#9200000000000000"));
  hear(frameOf("241#8000000000000000"));
  for (int i = 0; i < 20; ++i) {
    const auto second = tick();
    const auto third = tick();
    EXPECT_THAT((std::vector{second.at(0), third.at(0)}), UnorderedElementsAre(kOff, kRead)) << "by turns";
  }
}

TEST_F(MyActuatorMotor, PollingTurnsTheOutputOffInEachTurnUntilTheDriveHasAnsweredIt) {
  comeOnline();
  for (int before = 0; before < 4; ++before) {
    (void)told({.mode = ControlMode::kVelocity, .value = 100.0});
    if (before % 2 != 0) (void)tick();
    if (before / 2 != 0) hear(frameOf("241#8000000000000000"));  // the answer to another poll
    motor_.order(FrameKind::kPoll);
    int readings = 0;
    for (int turn = 0; turn < 10; ++turn) {
      const auto sent = tick();
      EXPECT_EQ(sent.at(0), kOff) << before << ", turn " << turn;
      readings += static_cast<int>(std::count(sent.begin(), sent.end(), kRead));
    }
    EXPECT_GE(readings, 4) << "it is read all the same";
    hear(frameOf("241#8000000000000000"));
    EXPECT_NE(tick().at(0), tick().at(0));
  }
}

TEST_F(MyActuatorMotor, AfterASilenceAPollTurnsTheOutputOffAnew) {
  comeOnline();
  motor_.order(FrameKind::kPoll);
  (void)tick();
  hear(frameOf("241#8000000000000000"));
  pass(std::chrono::milliseconds{200});
  for (int turn = 0; turn < 4; ++turn) EXPECT_EQ(tick().at(0), kOff) << turn;
}

TEST_F(MyActuatorMotor, PollingTurnsTheOutputOffInItsFirstTurnWhenThatComesLater) {
  MotorSettings settings = settingsOf();
  settings.command_divider = 4;
  for (std::uint64_t begin = 0; begin < 8; ++begin) {
    MyActuator_Motor slow = motorOf(settings);
    std::string first;
    for (std::uint64_t i = 0; i < begin + 4 && first.empty(); ++i) {
      slow.order(i < begin ? FrameKind::kIdle : FrameKind::kPoll);
      const Tick tick{.index = i, .now = now_, .dt_s = 0.001F};
      slow.update(tick);
      std::array<CanFrame, 4> out{};
      if (slow.packCommand(tick, out) > 0 && i >= begin) first = textOf(out[0]);
    }
    EXPECT_EQ(first, "141#8000000000000000") << "polled from tick " << begin << " on";
  }
}

TEST_F(MyActuatorMotor, PollingAsksForErrorsAndRunTimeNowAndThen) {
  motor_.order(FrameKind::kPoll);
  comeOnline();
  int status = 0;
  int uptime = 0;
  for (int i = 0; i < 1000; ++i) {
    hear(angleReply(1000));
    for (const auto& frame : tick()) {
      status += frame == "141#9A00000000000000" ? 1 : 0;
      uptime += frame == "141#B100000000000000" ? 1 : 0;
    }
  }
  EXPECT_NEAR(status, 10, 1);
  EXPECT_NEAR(uptime, 10, 1);
}

TEST_F(MyActuatorMotor, ReadsItsFeedbackInUnitsOfTheOutputShaft) {
  comeOnline(36000);
  hear(frameOf("241#A1329CFF0CFED3FF"));
  const auto& feedback = motor_.feedback();
  EXPECT_EQ(feedback.samples, 1U);
  EXPECT_NEAR(feedback.velocity_rpm, -500.0 / 6.0, 1e-4);
  EXPECT_FLOAT_EQ(feedback.current_a, -1.0F);
  EXPECT_NEAR(feedback.torque_nm, -10.0 / 3.2, 1e-4);
  EXPECT_FLOAT_EQ(feedback.temperature_c, 50.0F);
  EXPECT_FLOAT_EQ(feedback.voltage_v, 48.0F);
  EXPECT_FALSE(feedback.zeroed);
  hear(angleReply(36000 + 4500));
  EXPECT_NEAR(feedback.total_angle_deg, 45.0, 1e-9);
}

TEST_F(MyActuatorMotor, GoesOnWhereThirtyTwoBitsEnd) {
  comeOnline(2147483600);
  const double before = motor_.feedback().total_angle_deg;
  hear(angleReply(-2147483600));
  EXPECT_NEAR(motor_.feedback().total_angle_deg - before, 0.96, 1e-6);
  EXPECT_EQ(told({.mode = ControlMode::kTotalAngle, .value = motor_.feedback().total_angle_deg}).substr(12),
            textOf(angleReply(-2147483600)).substr(12));
}

TEST_F(MyActuatorMotor, TakesNoAngleBeforeItKnowsSinceWhenTheDriveRuns) {
  hear(frameOf("241#9A1E0000E0010000"));
  hear(angleReply(1000));
  EXPECT_EQ(motor_.feedback().samples, 0U);
  hear(uptimeReply(5000));
  hear(angleReply(1000));
  EXPECT_EQ(motor_.feedback().samples, 1U);
}

TEST_F(MyActuatorMotor, CopiesOfRequestsAreNotFeedback) {
  comeOnline(1000);
  hear(frameOf("241#9C1E6400F4012D00"));
  const std::string sent = told({.mode = ControlMode::kVelocity, .value = 100.0});
  hear(frameOf("241#" + sent.substr(4)));
  hear(frameOf("241#9C00000000000000"));
  hear(frameOf("241#9A00000000000000"));
  EXPECT_NEAR(motor_.feedback().velocity_rpm, 500.0 / 6.0, 1e-4);
  EXPECT_FLOAT_EQ(motor_.feedback().temperature_c, 30.0F);
  EXPECT_FLOAT_EQ(motor_.feedback().voltage_v, 48.0F);
}

TEST_F(MyActuatorMotor, OneCopyOfTheAngleRequestIsNotTheAngleZero) {
  comeOnline(9000);
  hear(angleReply(9000));
  const double before = motor_.feedback().total_angle_deg;
  hear(angleReply(0));
  EXPECT_EQ(motor_.feedback().total_angle_deg, before);
  hear(angleReply(0));
  EXPECT_NEAR(motor_.feedback().total_angle_deg, before - 90.0, 1e-9) << "it is at 0 indeed";
}

TEST_F(MyActuatorMotor, SaysThatTheDrivesOwnWatchdogHasStoppedIt) {
  comeOnline();
  (void)told({.mode = ControlMode::kVelocity, .value = 100.0});
  CanFrame notice = frameOf("241#F1");
  hear(notice);
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kDriveCommunication);
  EXPECT_EQ(motor_.complaint().native_code, 0xF1U);
  motor_.clearComplaint();
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kNone);
}

class RestartedMyActuatorMotor : public MyActuatorMotor {
 protected:
  /// Its drive says that it runs for a moment only.
  void expectThatItIsNoticed() {
    hear(uptimeReply(150));
    EXPECT_EQ(motor_.complaint().fault, FaultCode::kDriveStopped);
    EXPECT_FALSE(motor_.feedback().zeroed);
    motor_.order(FrameKind::kPoll);
    (void)tick();
    motor_.clearComplaint();
    EXPECT_EQ(motor_.complaint().fault, FaultCode::kNone);
  }
};

TEST_F(RestartedMyActuatorMotor, IsAComplaintWhileItWasToObeyAndTheReferenceIsLost) {
  comeOnline(9000);
  ASSERT_TRUE(motor_.setZero(0.0));
  (void)told({.mode = ControlMode::kTotalAngle, .value = 10.0});
  pass(std::chrono::milliseconds{400});
  hear(angleReply(500));  // within a turn of the rotor after the restart
  EXPECT_TRUE(motor_.feedback().zeroed) << "not taken yet";
  EXPECT_EQ(motor_.feedback().total_angle_deg, 0.0);
  const auto sent = tick();
  EXPECT_EQ(sent.at(0), kOff) << "its last command may act on";
  EXPECT_THAT(sent, Each(Not(StartsWith("141#A")))) << "told nothing else until it is known";
  expectThatItIsNoticed();
}

TEST_F(RestartedMyActuatorMotor, IsNoticedAfterAMonth) {
  for (const std::uint32_t uptime_ms : {2'147'483'000U, 2'592'000'000U, 4'294'960'000U}) {
    SCOPED_TRACE(uptime_ms);
    uptime_ms_ = uptime_ms;
    comeOnline(9000);
    ASSERT_TRUE(motor_.setZero(0.0));
    (void)told({.mode = ControlMode::kTotalAngle, .value = 10.0});
    pass(std::chrono::milliseconds{400});
    (void)tick();
    expectThatItIsNoticed();
  }
}

TEST_F(MyActuatorMotor, ASilenceWithoutARestartKeepsTheReference) {
  comeOnline(9000);
  ASSERT_TRUE(motor_.setZero(0.0));
  pass(std::chrono::seconds{100});
  hear(uptimeReply(uptime_ms_ + 99'700));
  hear(angleReply(9100));
  EXPECT_TRUE(motor_.feedback().zeroed);
  EXPECT_NEAR(motor_.feedback().total_angle_deg, 1.0, 1e-9);
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kNone);
}

TEST_F(MyActuatorMotor, TheRunTimeMayWrapWithoutBeingARestart) {
  uptime_ms_ = 0xFFFF'FFF0U;
  comeOnline(9000);
  ASSERT_TRUE(motor_.setZero(0.0));
  pass(std::chrono::milliseconds{50});
  hear(uptimeReply(34));
  EXPECT_TRUE(motor_.feedback().zeroed);
}

TEST_F(MyActuatorMotor, EveryKnownErrorHasItsFaultCode) {
  comeOnline();
  ASSERT_GE(myactuatorFaults().size(), 8U);
  for (const DriveFault& fault : myactuatorFaults()) {
    CanFrame frame = frameOf("241#9A1E0000E0010000");
    writeLittleEndian(frame.data, 6, static_cast<std::uint16_t>(fault.native));
    hear(frame);
    EXPECT_EQ(motor_.complaint().fault, fault.fault) << fault.words;
    EXPECT_EQ(motor_.complaint().native_code, fault.native);
    EXPECT_FALSE(fault.words.empty());
  }
  hear(frameOf("241#9A1E0000E0010002"));
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kDriveOther);
  hear(frameOf("241#9A1E0000E0010000"));
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kNone);
}

TEST_F(MyActuatorMotor, OnlyErrorsThatNeedItAreClearedByARestartOfTheDrive) {
  comeOnline();
  motor_.order(FrameKind::kPoll);
  hear(frameOf("241#9A1E0000E0010400"));
  motor_.clearComplaint();
  EXPECT_THAT(tick(), Not(Contains("141#7600000000000000")));
  hear(frameOf("241#9A1E0000E0010200"));
  EXPECT_THAT(tick(), Not(Contains("141#7600000000000000"))) << "only when asked";
  motor_.clearComplaint();
  EXPECT_THAT(tick(), Contains("141#7600000000000000"));
  EXPECT_THAT(tick(), Not(Contains("141#7600000000000000")));
}

TEST_F(MyActuatorMotor, FramesThatAreNotItsOwnAreLeftAlone) {
  CanFrame frame = frameOf("242#9C326400F4012D00");
  EXPECT_FALSE(motor_.matchesFrame(frame));
  frame = frameOf("241#9C326400F4012D00");
  frame.id.extended = true;
  EXPECT_FALSE(motor_.matchesFrame(frame));
  frame.id.extended = false;
  frame.fd = true;
  EXPECT_FALSE(motor_.matchesFrame(frame));
  EXPECT_EQ(motor_.updateFeedback(frame), FrameVerdict::kMalformed);
  frame.fd = false;
  frame.type = FrameType::kRemote;
  EXPECT_EQ(motor_.updateFeedback(frame), FrameVerdict::kMalformed);
  EXPECT_EQ(hear(frameOf("241#9C326400F4012D")), FrameVerdict::kMalformed);
  EXPECT_EQ(hear(frameOf("241#")), FrameVerdict::kMalformed);
  EXPECT_EQ(hear(frameOf("501#02E66682EB550000")), FrameVerdict::kMalformed) << "another drive's id inside";
  EXPECT_EQ(motor_.feedback().samples, 0U);
}

TEST_F(MyActuatorMotor, AnythingMayArriveAndReadingsStayFinite) {
  std::mt19937 random(1);  // NOLINT: the same numbers every time
  comeOnline();
  for (int i = 0; i < 20000; ++i) {
    CanFrame frame = frameOf(random() % 4 == 0 ? "501#0100000000000000" : "241#0000000000000000");
    constexpr std::array<std::uint8_t, 8> kCodes{0x92, 0x9A, 0x9C, 0xA1, 0xA2, 0xA4, 0xB1, 0xF1};
    for (auto& byte : std::span(frame.data).first(8)) byte = static_cast<std::uint8_t>(random());
    frame.data[0] = frame.id.value == 0x501 ? 1 : kCodes[random() % kCodes.size()];
    hear(frame);
    if (random() % 3 == 0) (void)told({.mode = ControlMode::kTotalAngle, .value = 10.0});
    const auto& feedback = motor_.feedback();
    ASSERT_TRUE(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.angle_deg));
    ASSERT_TRUE(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  }
}

}  // namespace
}  // namespace rc10::test::myactuator_motor_test
