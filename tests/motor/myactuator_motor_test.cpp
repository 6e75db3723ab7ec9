#include "drives/myactuator/myactuator_motor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bus/byte_order.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_model.hpp"
#include "support/frame_bytes.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::myactuator_motor_test {
namespace {

using myactuator::Code;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kOff = "141#8000000000000000";
const std::string kRead = "141#9C00000000000000";

MotorSettings settingsOf(std::string model = "RMD-X8-25") {
  MotorSettings settings;
  settings.name = "joint";
  settings.model = std::move(model);
  settings.id = 1;
  settings.own = ownDefaults(myactuatorFamily());
  return settings;
}

MyActuator_Motor motorOf(const MotorSettings& settings) {
  return MyActuator_Motor(settings, myactuatorFamily().traits(settings.model, settings.own));
}

CanFrame angleReply(std::int32_t raw) {
  CanFrame frame = frameOf("241#9200000000000000");
  writeLittleEndian(frame.data, 4, raw);
  return frame;
}

CanFrame uptimeReply(std::uint32_t ms) {
  CanFrame frame = frameOf("241#B100000000000000");
  writeLittleEndian(frame.data, 4, ms);
  return frame;
}

/// Hands frames over at 1 ms spacing, answering nothing by itself.
class MyActuatorMotor : public testing::Test {
 protected:
  explicit MyActuatorMotor(const MotorSettings& settings = settingsOf()) : motor_(motorOf(settings)) {}

  FrameVerdict hear(CanFrame frame) {
    frame.received = now_;
    EXPECT_TRUE(motor_.matchesFrame(frame));
    return motor_.updateFeedback(frame);
  }
  std::vector<std::string> tick() {
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_.packCommand(tick, out);
    std::vector<std::string> sent;
    for (std::size_t i = 0; i < count; ++i) sent.push_back(textOf(out[i]));
    return sent;
  }
  void pass(Duration duration) { now_ += duration; }
  /// As a drive that has been running for a while.
  void comeOnline(std::int32_t raw_angle = 1000) {
    hear(frameOf("241#9A1E0000E0010000"));  // 30 degC, 48 V
    hear(uptimeReply(uptime_ms_));
    hear(angleReply(raw_angle));
  }
  std::string told(const Target& target) {
    motor_.order(FrameKind::kCommand, target);
    return tick().at(0);
  }

  MyActuator_Motor motor_;
  MonotonicTime now_{std::chrono::hours{1}};
  std::uint64_t ticks_ = 0;
  std::uint32_t uptime_ms_ = 60'000;
};

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

TEST_F(MyActuatorMotor, ARestartWhileItWasToObeyIsAComplaintAndTheReferenceIsLost) {
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
  hear(uptimeReply(150));
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(motor_.feedback().zeroed);
  motor_.order(FrameKind::kPoll);
  (void)tick();
  motor_.clearComplaint();
  EXPECT_EQ(motor_.complaint().fault, FaultCode::kNone);
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

TEST_F(MyActuatorMotor, TargetsBecomeTheDrivesOwnCommands) {
  comeOnline(1000);
  ASSERT_TRUE(motor_.setZero(0.0));
  EXPECT_EQ(told({.mode = ControlMode::kCurrent, .value = -1.0}), "141#A10000009CFF0000");
  EXPECT_EQ(told({.mode = ControlMode::kVelocity, .value = -100.0 / 6.0}), "141#A2000000F0D8FFFF");
  EXPECT_EQ(told({.mode = ControlMode::kTotalAngle, .value = 350.0}), "141#A400FFFFA08C0000");
  EXPECT_EQ(told({.mode = ControlMode::kAngle, .value = 350.0}), "141#A400FFFF00000000") << "the short way";
  EXPECT_EQ(told({.mode = ControlMode::kBrake}), "141#A200000000000000");
  EXPECT_EQ(told({.mode = ControlMode::kCoast}), "141#A100000000000000");
  EXPECT_THAT(told({.mode = ControlMode::kImpedance, .stiffness_nm_per_rad = 5.0F}), StartsWith("401#"));
  motor_.order(FrameKind::kIdle);
  EXPECT_EQ(tick().at(0), "141#A100000000000000");
  motor_.order(FrameKind::kBrake);
  EXPECT_EQ(tick().at(0), "141#A200000000000000");
  motor_.order(FrameKind::kHold);
  EXPECT_EQ(tick().at(0), "141#A400FFFFE8030000") << "where it is";
  motor_.order(FrameKind::kDamp);
  EXPECT_THAT(tick().at(0), StartsWith("401#"));
}

TEST_F(MyActuatorMotor, TheAngleIsAskedForWithEveryCommandOrEveryNth) {
  MotorSettings settings = settingsOf();
  settings.own.set("angle_divider", 4.0);
  MyActuator_Motor slow = motorOf(settings);
  EXPECT_EQ(slow.feedbackPeriod(), std::chrono::milliseconds{4});
  slow.order(FrameKind::kPoll);
  int asked = 0;
  for (int i = 0; i < 100; ++i) {
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    slow.update(tick);
    std::array<CanFrame, 4> out{};
    const auto count = slow.packCommand(tick, out);
    for (std::size_t n = 0; n < count; ++n) asked += out[n].data[0] == 0x92 ? 1 : 0;
  }
  EXPECT_EQ(asked, 25);
}

TEST_F(MyActuatorMotor, NothingIsSentBetweenItsTurns) {
  MotorSettings settings = settingsOf();
  settings.command_divider = 4;
  settings.command_phase = 1;
  MyActuator_Motor slow = motorOf(settings);
  slow.order(FrameKind::kRest);
  std::array<CanFrame, 4> out{};
  for (std::uint64_t i = 0; i < 16; ++i) {
    const Tick tick{.index = i, .now = now_, .dt_s = 0.001F};
    slow.update(tick);
    EXPECT_EQ(slow.packCommand(tick, out), i % 4 == 1 ? 1U : 0U);
  }
}

TEST_F(MyActuatorMotor, LimitsBoundWhatIsSentAndSaySo) {
  MotorSettings settings = settingsOf();
  settings.effort_limit = 2.0F;
  settings.velocity_limit_rpm = 50.0F;
  MyActuator_Motor bounded = motorOf(settings);
  for (CanFrame frame : {uptimeReply(1000), angleReply(1000)}) {
    frame.received = now_;
    (void)bounded.updateFeedback(frame);
  }
  const auto send = [&](const Target& target) {
    bounded.order(FrameKind::kCommand, target);
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    bounded.update(tick);
    std::array<CanFrame, 4> out{};
    (void)bounded.packCommand(tick, out);
    return textOf(out[0]);
  };
  EXPECT_EQ(send({.mode = ControlMode::kCurrent, .value = 1e9}), "141#A1000000C8000000");
  EXPECT_EQ(bounded.limits(), kLimitCurrent);
  EXPECT_EQ(send({.mode = ControlMode::kVelocity, .value = -1e9}), "141#A2000000D08AFFFF");
  EXPECT_EQ(bounded.limits(), kLimitVelocity);
  EXPECT_EQ(send({.mode = ControlMode::kTotalAngle, .value = 1e300}), "141#A4002C01FFFFFF7F");
  EXPECT_EQ(bounded.limits(), kLimitAngle);
  bounded.derate(0.5F);
  EXPECT_EQ(send({.mode = ControlMode::kCurrent, .value = -5.0}), "141#A10000009CFF0000");
  bounded.derate(0.0F);
  EXPECT_EQ(send({.mode = ControlMode::kVelocity, .value = 10.0}), "141#A100000000000000")
      << "no loop of the drive when no torque is allowed";
}

TEST_F(MyActuatorMotor, NonFiniteAndHugeTargetsAreHarmless) {
  comeOnline(1000);
  for (const double value : {std::nan(""), kInfinity, -kInfinity, 1e300, -1e300}) {
    for (int mode = 0; mode < kControlModeCount; ++mode) {
      Target target{.mode = static_cast<ControlMode>(mode), .value = value};
      target.velocity_ff_rpm = static_cast<float>(value);
      target.torque_ff_nm = static_cast<float>(value);
      target.stiffness_nm_per_rad = static_cast<float>(value);
      target.damping_nms_per_rad = static_cast<float>(value);
      const std::string frame = told(target);
      EXPECT_EQ(frame.size(), 20U);
      EXPECT_FALSE(std::isnan(motor_.commandValue())) << mode;
    }
  }
}

TEST_F(MyActuatorMotor, ImpedanceNeverAsksForMoreTorqueThanTheLimitAllows) {
  MotorSettings settings = settingsOf();
  settings.effort_limit = 1.0F;  // 3.125 N·m
  MyActuator_Motor soft = motorOf(settings);
  std::mt19937 random(7);  // NOLINT: the same numbers every time
  std::uniform_real_distribution<double> angle(-700.0, 700.0);
  std::uniform_real_distribution<double> gain(0.0, 1000.0);
  std::uniform_real_distribution<double> torque(-100.0, 100.0);
  for (int i = 0; i < 2000; ++i) {
    const auto raw = static_cast<std::int32_t>(angle(random) * 100.0);
    for (CanFrame frame : {uptimeReply(static_cast<std::uint32_t>(1000 + i)), angleReply(raw | 1)}) {
      frame.received = now_;
      (void)soft.updateFeedback(frame);
    }
    (void)soft.setZero((raw | 1) * 0.01);
    soft.order(FrameKind::kCommand, {.mode = ControlMode::kImpedance,
                                     .value = angle(random),
                                     .torque_ff_nm = static_cast<float>(torque(random)),
                                     .stiffness_nm_per_rad = static_cast<float>(gain(random)),
                                     .damping_nms_per_rad = 0.0F});
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    soft.update(tick);
    std::array<CanFrame, 4> out{};
    (void)soft.packCommand(tick, out);
    ASSERT_EQ(out[0].id.value, 0x401U);
    const auto& d = out[0].data;
    const double p = (d[0] << 8 | d[1]) * 25.0 / 65535.0 - 12.5;
    const double kp = ((d[3] & 0xF) << 8 | d[4]) * 500.0 / 4095.0;
    const double ff = ((d[6] & 0xF) << 8 | d[7]) * 48.0 / 4095.0 - 24.0;
    const double here = (raw | 1) * 0.01 * std::numbers::pi / 180.0;
    // A step of the stiffness is 0.122 N·m/rad, of the torque 0.012 N·m.
    EXPECT_LE(std::abs(kp * (p - here) + ff), 3.125 + 0.07 * std::abs(p - here) + 0.02 + kp * 0.0003);
  }
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

TEST_F(MyActuatorMotor, SpeedsAndAnglesSurviveTheWayThereAndBack) {
  std::mt19937 random(3);  // NOLINT: the same numbers every time
  std::uniform_real_distribution<double> deg(-2e7, 2e7);
  for (int i = 0; i < 2000; ++i) {
    const double value = deg(random);
    const auto frame = myactuator::positionCommand(1, value, 100.0);
    EXPECT_NEAR(readLittleEndian<std::int32_t>(frame.payload(), 4) * 0.01, value, 0.00501);
  }
}

TEST(MyactuatorFamily, KnowsItsModelsAndWhatTheyNeed) {
  const auto& family = myactuatorFamily();
  ASSERT_GE(family.models().size(), 10U);
  for (const auto model : family.models()) {
    const auto traits = family.traits(model, ownDefaults(family));
    EXPECT_EQ(traits.max_id, 32);
    EXPECT_TRUE(traits.asked);
    EXPECT_FALSE(traits.watchdog) << "setting it would write the drive's ROM";
    EXPECT_GT(traits.effort_full_scale, 0.0F);
    EXPECT_TRUE(traits.modes.contains(ControlMode::kVelocity));
    EXPECT_EQ(traits.modes.contains(ControlMode::kImpedance), model != "RMD-X") << model;
  }
  auto own = ownDefaults(family);
  own.set("torque_nm_per_a", 2.0);
  EXPECT_TRUE(family.traits("RMD-X", own).modes.contains(ControlMode::kImpedance));
}

TEST(MyactuatorFamily, TellsWhichIdsItUsesAndHowOften) {
  auto settings = settingsOf();
  settings.id = 5;
  settings.command_divider = 2;
  const auto use = myactuatorFamily().busUse(settings);
  EXPECT_EQ(use.sends[0].id.value, 0x245U);
  EXPECT_EQ(use.sends[1].id.value, 0x505U);
  std::vector<std::uint32_t> obeyed;
  for (const auto& filter : use.obeys) obeyed.push_back(filter.id.value);
  EXPECT_THAT(obeyed, ElementsAre(0x145, 0x405, 0x280, 0x300));
  EXPECT_NEAR(use.commands[0].per_second, 1020.0, 1e-9);
  EXPECT_NEAR(use.feedback[0].per_second, 1020.0, 1e-9);
}

}  // namespace
}  // namespace rc10::test::myactuator_motor_test
