#include "daemon/clients/admission.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>
#include <utility>

#include "daemon/described_robot.hpp"
#include "daemon/link_messages.hpp"

namespace rc10::test::admission_test {
namespace {

using namespace std::chrono_literals;
using enum ControlMode;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfF = std::numeric_limits<float>::infinity();

class AdmissionTest : public ::testing::Test {
 protected:
  [[nodiscard]] CommandRefusal admit(const link::Command& message) {
    return admission.admit(message, speaker, now, out);
  }
  /// A message with one setpoint and the next sequence number.
  [[nodiscard]] link::Command one(const link::Setpoint& setpoint) {
    return linkCommand(++seq, now, {setpoint});
  }
  [[nodiscard]] link::Command good() { return one(setpoint("left", kVelocity, 120.0)); }
  [[nodiscard]] link::Command spring() {
    auto message = one(setpoint("arm", kImpedance, 10.0));
    message.setpoints[0].target.stiffness_nm_per_rad = 5.0F;
    message.setpoints[0].target.damping_nms_per_rad = 0.5F;
    return message;
  }

  MonotonicTime now{1000s};
  std::int64_t seq = 0;
  Speaker speaker;
  Command out;
  static RobotDescription described() {
    auto robot = describedRobot({"left", "right", "arm"});
    robot.motors[0].modes = ModeSet{kCurrent, kVelocity, kAngle};
    robot.motors[1].modes = ModeSet{kCurrent, kVelocity, kBrake};
    robot.motors[2].modes = ModeSet{kImpedance};
    return robot;
  }
  RobotDescription robot = described();
  Admission admission{robot};
};

TEST_F(AdmissionTest, TranslatesNamesModesAndValues) {
  auto message = linkCommand(1, now, {setpoint("right", kVelocity, 120.0), setpoint("left", kCurrent, -2.0)});
  message.setpoints[0].target.torque_ff_nm = 4.0F;
  ASSERT_EQ(admit(message), CommandRefusal::kNone);
  ASSERT_EQ(out.count, 2U);
  EXPECT_EQ(out.client.view(), "planner");
  EXPECT_EQ(out.setpoints[0].motor, 1U);
  EXPECT_EQ(out.setpoints[0].target.mode, kVelocity);
  EXPECT_EQ(out.setpoints[0].target.value, 120.0);
  EXPECT_EQ(out.setpoints[0].target.torque_ff_nm, 4.0F);
  EXPECT_EQ(out.setpoints[1].motor, 0U);
  EXPECT_EQ(out.setpoints[1].target.mode, kCurrent);
  EXPECT_EQ(out.setpoints[1].target.value, -2.0);
}

TEST_F(AdmissionTest, KnowsTheIndexOfEveryMotorAndOfNoOther) {
  EXPECT_EQ(admission.indexOf("left"), 0);
  EXPECT_EQ(admission.indexOf("arm"), 2);
  EXPECT_EQ(admission.indexOf("Left"), -1);
  EXPECT_EQ(admission.indexOf(""), -1);
}

TEST_F(AdmissionTest, RefusesAMessageWithoutSetpoints) {
  EXPECT_EQ(admit(linkCommand(1, now, {})), CommandRefusal::kMalformed);
}

TEST_F(AdmissionTest, RefusesMoreSetpointsThanThereIsRoom) {
  auto message = good();
  message.setpoint_count = kMaxMotors + 1;
  EXPECT_EQ(admit(message), CommandRefusal::kMalformed);
}

TEST_F(AdmissionTest, TakesAsManySetpointsAsThereAreMotors) {
  RobotDescription many;
  auto message = linkCommand(1, now, {});
  for (std::size_t i = 0; i < kMaxMotors; ++i) {
    many.motors.emplace_back().name = "m" + std::to_string(i);
    message.setpoints[message.setpoint_count++] = setpoint(many.motors.back().name, kCoast);
  }
  Admission full{many};
  EXPECT_EQ(full.admit(message, {}, now, out), CommandRefusal::kNone);
  EXPECT_EQ(out.count, kMaxMotors);
}

TEST_F(AdmissionTest, ACommandCarriesItsSenderAndItsTimes) {
  auto message = good();
  message.session = 9;
  message.priority = -3;
  message.received_ns = (now - 5ms).time_since_epoch().count();
  ASSERT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(out.session, 9U);
  EXPECT_EQ(out.priority, -3);
  EXPECT_EQ(out.received, now - 5ms);
}

TEST_F(AdmissionTest, RefusesAMessageThatNamesOneMotorTwice) {
  EXPECT_EQ(admit(linkCommand(1, now, {setpoint("left", kVelocity), setpoint("left", kCurrent)})),
            CommandRefusal::kMalformed);
}

TEST_F(AdmissionTest, RefusesAnUnknownMotor) {
  EXPECT_EQ(admit(one(setpoint("lefty", kVelocity))), CommandRefusal::kUnknownMotor);
  EXPECT_EQ(admit(one(setpoint("", kVelocity))), CommandRefusal::kUnknownMotor);
}

TEST_F(AdmissionTest, RefusesANumberThatIsNoMode) {
  auto message = good();
  message.setpoints[0].target.mode = ControlMode{kControlModeCount};
  EXPECT_EQ(admit(message), CommandRefusal::kUnknownMode);
  message.setpoints[0].target.mode = ControlMode{255};
  EXPECT_EQ(admit(message), CommandRefusal::kUnknownMode);
}

TEST_F(AdmissionTest, RefusesAModeThatTheMotorCannotDo) {
  EXPECT_EQ(admit(one(setpoint("left", kDuty))), CommandRefusal::kUnsupportedMode);
  EXPECT_EQ(admission.choice(), "; it has current,velocity,angle");
  EXPECT_EQ(admit(one(setpoint("left", kBrake))), CommandRefusal::kUnsupportedMode);
  EXPECT_EQ(admit(one(setpoint("right", kBrake))), CommandRefusal::kNone);
}

TEST_F(AdmissionTest, EveryMotorCanCoast) {
  EXPECT_EQ(admit(one(setpoint("arm", kCoast))), CommandRefusal::kNone);
}

TEST_F(AdmissionTest, AValueThatTheModeHasNoUseForGoesNoFurther) {
  EXPECT_EQ(admit(one(setpoint("left", ControlMode::kCoast, kNan))), CommandRefusal::kNone);
  EXPECT_EQ(out.setpoints[0].target.value, 0.0);
}

TEST_F(AdmissionTest, AFieldThatAModeDoesNotUseIsClearedAndTold) {
  auto with_ff = setpoint("left", kVelocity, 100.0);
  with_ff.target.velocity_ff_rpm = 50.0F;
  with_ff.target.torque_ff_nm = 1.0F;
  EXPECT_EQ(admit(one(with_ff)), CommandRefusal::kNone);
  EXPECT_TRUE(admission.clearedField());
  EXPECT_EQ(out.setpoints[0].target.velocity_ff_rpm, 0.0F);
  EXPECT_EQ(out.setpoints[0].target.torque_ff_nm, 1.0F);
  with_ff.target.mode = kAngle;
  EXPECT_EQ(admit(one(with_ff)), CommandRefusal::kNone);
  EXPECT_FALSE(admission.clearedField());
  EXPECT_EQ(out.setpoints[0].target.velocity_ff_rpm, 50.0F);
}

TEST_F(AdmissionTest, EachFieldThatAModeDoesNotUseIsNoticedByItself) {
  const auto cleared = [&](ControlMode mode, auto set) {
    auto message = one(setpoint("left", mode, 1.0));
    set(message.setpoints[0].target);
    EXPECT_EQ(admit(message), CommandRefusal::kNone);
    return admission.clearedField();
  };
  EXPECT_FALSE(cleared(kVelocity, [](auto&) {}));
  for (const float given : {0.5F, -0.5F}) {
    EXPECT_TRUE(cleared(kVelocity, [&](auto& target) { target.velocity_ff_rpm = given; }));
    EXPECT_FALSE(cleared(kVelocity, [&](auto& target) { target.torque_ff_nm = given; }));
    EXPECT_TRUE(cleared(kVelocity, [&](auto& target) { target.stiffness_nm_per_rad = given; }));
    EXPECT_TRUE(cleared(kVelocity, [&](auto& target) { target.damping_nms_per_rad = given; }));
    EXPECT_TRUE(cleared(kCoast, [&](auto& target) { target.torque_ff_nm = given; }));
  }
  EXPECT_FALSE(cleared(kCoast, [](auto& target) {
    target.velocity_ff_rpm = target.torque_ff_nm = kNanF;
    target.stiffness_nm_per_rad = target.damping_nms_per_rad = kNanF;
  })) << "not given";
}

TEST_F(AdmissionTest, OneClearedFieldOfAMessageIsNoticedWhereverItStands) {
  for (const std::size_t at : {0U, 1U}) {
    auto message =
        linkCommand(++seq, now, {setpoint("left", kVelocity, 1.0), setpoint("right", kVelocity, 1.0)});
    message.setpoints[at].target.velocity_ff_rpm = 5.0F;
    EXPECT_EQ(admit(message), CommandRefusal::kNone);
    EXPECT_TRUE(admission.clearedField());
  }
}

TEST_F(AdmissionTest, RefusesAValueThatIsNotFinite) {
  EXPECT_EQ(admit(one(setpoint("left", kVelocity, kNan))), CommandRefusal::kNotFinite);
  EXPECT_EQ(admit(one(setpoint("left", kVelocity, std::numeric_limits<double>::infinity()))),
            CommandRefusal::kNotFinite);
}

TEST_F(AdmissionTest, RefusesGainsThatTheDriveCannotTakeAndNamesItsRange) {
  robot.motors[2].spring_range = {.stiffness_nm_per_rad = 500.0, .damping_nms_per_rad = 5.0};
  auto message = spring();
  message.setpoints[0].target.stiffness_nm_per_rad = 500.0F;
  message.setpoints[0].target.damping_nms_per_rad = 5.0F;
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(admission.choice(), "");
  for (const auto& [stiffness, damping] :
       {std::pair{1e6F, 0.5F}, {501.0F, 0.5F}, {20.0F, 5.1F}, {-1.0F, 0.5F}, {20.0F, -0.1F}}) {
    message = spring();
    message.setpoints[0].target.stiffness_nm_per_rad = stiffness;
    message.setpoints[0].target.damping_nms_per_rad = damping;
    EXPECT_EQ(admit(message), CommandRefusal::kGainsBeyondDrive) << stiffness << ", " << damping;
    EXPECT_EQ(admission.culprit(), "arm: impedance");
    EXPECT_EQ(admission.choice(), ": 0 to 500 Nm/rad, 0 to 5 Nms/rad");
  }
  EXPECT_EQ(admit(one(setpoint("left", kVelocity, kNan))), CommandRefusal::kNotFinite);
  EXPECT_EQ(admission.choice(), "") << "of the refusal before";
}

TEST_F(AdmissionTest, GainsOfADriveOfUnknownRangeAreNotJudged) {
  auto message = spring();
  message.setpoints[0].target.stiffness_nm_per_rad = 1e6F;
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
}

TEST_F(AdmissionTest, AFeedForwardThatIsNotGivenIsNone) {
  auto message = good();
  message.setpoints[0].target.velocity_ff_rpm = kNanF;
  message.setpoints[0].target.torque_ff_nm = kNanF;
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(out.setpoints[0].target.velocity_ff_rpm, 0.0F);
  EXPECT_EQ(out.setpoints[0].target.torque_ff_nm, 0.0F);
}

TEST_F(AdmissionTest, RefusesInfinityInEveryField) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double sign : {1.0, -1.0}) {
    const auto with = [&](auto set) {
      auto message = spring();
      set(message.setpoints[0].target);
      return admit(message);
    };
    const auto infinite = static_cast<float>(sign) * kInfF;
    EXPECT_EQ(with([](auto&) {}), CommandRefusal::kNone);
    EXPECT_EQ(with([&](auto& target) { target.value = sign * kInf; }), CommandRefusal::kNotFinite);
    EXPECT_EQ(with([&](auto& target) { target.velocity_ff_rpm = infinite; }), CommandRefusal::kNotFinite);
    EXPECT_EQ(with([&](auto& target) { target.torque_ff_nm = infinite; }), CommandRefusal::kNotFinite);
    EXPECT_EQ(with([&](auto& target) { target.stiffness_nm_per_rad = infinite; }),
              CommandRefusal::kNotFinite);
    EXPECT_EQ(with([&](auto& target) { target.damping_nms_per_rad = infinite; }), CommandRefusal::kNotFinite);
  }
}

TEST_F(AdmissionTest, IgnoresTheValueOfModesThatHaveNone) {
  EXPECT_EQ(admit(one(setpoint("left", kCoast, kNan))), CommandRefusal::kNone);
  EXPECT_EQ(admit(one(setpoint("right", kBrake, kNan))), CommandRefusal::kNone);
}

TEST_F(AdmissionTest, StiffnessAndDampingMayBeNanWhereTheyMeanNothing) {
  robot.motors[0].modes = ModeSet{kCurrent, kVelocity, kAngle, kTotalAngle, kVoltage, kDuty, kBrake};
  for (const auto mode : {kCoast, kCurrent, kVelocity, kAngle, kTotalAngle, kVoltage, kDuty, kBrake}) {
    auto message = one(setpoint("left", mode, 0.5));
    message.setpoints[0].target.stiffness_nm_per_rad = kNanF;
    message.setpoints[0].target.damping_nms_per_rad = kNanF;
    ASSERT_EQ(admit(message), CommandRefusal::kNone) << toString(mode);
    // They do not reach the motor.
    EXPECT_EQ(out.setpoints[0].target.stiffness_nm_per_rad, 0.0F);
    EXPECT_EQ(out.setpoints[0].target.damping_nms_per_rad, 0.0F);
  }
}

TEST_F(AdmissionTest, ImpedanceNeedsFiniteStiffnessAndDamping) {
  auto message = spring();
  ASSERT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(out.setpoints[0].target.stiffness_nm_per_rad, 5.0F);
  EXPECT_EQ(out.setpoints[0].target.damping_nms_per_rad, 0.5F);
  message.setpoints[0].target.stiffness_nm_per_rad = kNanF;
  EXPECT_EQ(admit(message), CommandRefusal::kNotFinite);
  message.setpoints[0].target.stiffness_nm_per_rad = 5.0F;
  message.setpoints[0].target.damping_nms_per_rad = kInfF;
  EXPECT_EQ(admit(message), CommandRefusal::kNotFinite);
}

TEST_F(AdmissionTest, RefusesTheWholeMessageForOneBadSetpoint) {
  EXPECT_EQ(
      admit(linkCommand(1, now, {setpoint("left", kVelocity, 1.0), setpoint("right", kVelocity, kNan)})),
      CommandRefusal::kNotFinite);
  // It has used up no sequence number.
  EXPECT_EQ(admit(linkCommand(1, now, {setpoint("left", kVelocity, 1.0)})), CommandRefusal::kNone);
}

TEST_F(AdmissionTest, TheDeadlineIsTheReceiveTimePlusTheValidity) {
  auto message = good();
  message.validity_ms = 20;
  message.received_ns = (now - 5ms).time_since_epoch().count();
  ASSERT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(out.deadline, now + 15ms);
}

TEST_F(AdmissionTest, AValidityOfZeroIsFiftyMilliseconds) {
  ASSERT_EQ(admit(good()), CommandRefusal::kNone);
  EXPECT_EQ(out.deadline, now + 50ms);
}

TEST_F(AdmissionTest, RefusesAValidityOutOfRange) {
  auto message = good();
  message.validity_ms = 1001;
  EXPECT_EQ(admit(message), CommandRefusal::kMalformed);
  message.validity_ms = -1;
  EXPECT_EQ(admit(message), CommandRefusal::kMalformed);
  message.validity_ms = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(admit(message), CommandRefusal::kMalformed);
  message.validity_ms = 1000;
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(out.deadline, now + 1000ms);
}

TEST_F(AdmissionTest, AReceiveTimeInTheFutureCountsAsNow) {
  auto message = good();
  message.received_ns = (now + 1h).time_since_epoch().count();
  ASSERT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_EQ(out.deadline, now + 50ms);
}

TEST_F(AdmissionTest, RefusesAMessageThatIsOlderThanItsValidity) {
  auto message = good();
  message.received_ns = (now - 50ms).time_since_epoch().count();
  EXPECT_EQ(admit(message), CommandRefusal::kExpired);
  ++message.seq;
  message.received_ns = (now - 50ms + 1ns).time_since_epoch().count();
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
  ++message.seq;
  message.received_ns = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ(admit(message), CommandRefusal::kExpired);
}

TEST_F(AdmissionTest, OneThatIsLateIsTheNewestOfItsSessionOnce) {
  auto message = good();
  ASSERT_EQ(admit(message), CommandRefusal::kNone);
  EXPECT_FALSE(admission.lateButNew());
  ++message.seq;
  message.received_ns = (now - 50ms).time_since_epoch().count();
  ASSERT_EQ(admit(message), CommandRefusal::kExpired);
  EXPECT_TRUE(admission.lateButNew());
  EXPECT_EQ(out.deadline, now);
  EXPECT_EQ(out.session, message.session);
  ASSERT_EQ(admit(message), CommandRefusal::kExpired) << "a replay";
  EXPECT_FALSE(admission.lateButNew());
}

TEST_F(AdmissionTest, SequenceNumbersOfASessionOnlyRise) {
  const auto numbered = [&](std::int64_t number) {
    return linkCommand(number, now, {setpoint("left", kVelocity)});
  };
  EXPECT_EQ(admit(numbered(5)), CommandRefusal::kNone);
  EXPECT_EQ(admit(numbered(5)), CommandRefusal::kOldSequence);
  EXPECT_EQ(admit(numbered(4)), CommandRefusal::kOldSequence);
  EXPECT_EQ(admit(numbered(9)), CommandRefusal::kNone) << "gaps are allowed";
  EXPECT_EQ(admit(numbered(6)), CommandRefusal::kOldSequence);
}

TEST_F(AdmissionTest, EverySessionOfAClientHasASequenceOfItsOwn) {
  auto first = linkCommand(100, now, {setpoint("left", kVelocity)});
  auto second = first;
  second.session = 8;
  second.seq = 1;
  EXPECT_EQ(admit(first), CommandRefusal::kNone);
  EXPECT_EQ(admit(second), CommandRefusal::kNone);
  EXPECT_EQ(out.session, 8U);
  EXPECT_EQ(admit(second), CommandRefusal::kOldSequence);
  EXPECT_EQ(admit(first), CommandRefusal::kOldSequence) << "the other session does not start this one anew";
}

TEST_F(AdmissionTest, EveryReasonHasWordsOfItsOwn) {
  std::set<std::string> names;
  std::set<std::string> words;
  for (std::size_t i = 0; i < kCommandRefusalCount; ++i) {
    names.insert(toString(static_cast<CommandRefusal>(i)));
    words.insert(describe(static_cast<CommandRefusal>(i)));
  }
  EXPECT_EQ(names.size(), kCommandRefusalCount);
  EXPECT_EQ(words.size(), kCommandRefusalCount);
  EXPECT_EQ(names.count("unknown"), 0U);
}

TEST_F(AdmissionTest, AConnectionIsOneSenderWhateverNamesItGives) {
  int passed = 0;
  for (int i = 0; i < 1000; ++i) {
    auto message = good();
    message.client = std::to_string(i).c_str();
    passed += admit(message) == CommandRefusal::kNone ? 1 : 0;
  }
  EXPECT_EQ(passed, 64) << "a burst that fills the ring";
}

TEST_F(AdmissionTest, TheWordsOfAReasonSayWhatToDo) {
  const auto says = [](CommandRefusal refusal, const char* part) {
    return std::string{describe(refusal)}.find(part) != std::string::npos;
  };
  EXPECT_STREQ(describe(CommandRefusal::kNone), "accepted");
  EXPECT_TRUE(says(CommandRefusal::kMalformed, "1 to 128 setpoints"));
  EXPECT_TRUE(says(CommandRefusal::kMalformed, "1 to 1000 ms"));
  EXPECT_TRUE(says(CommandRefusal::kUnknownMotor, "rc10ctl watch"));
  EXPECT_TRUE(says(CommandRefusal::kUnknownMode, "unknown mode"));
  EXPECT_TRUE(says(CommandRefusal::kUnsupportedMode, "does not support"));
  EXPECT_TRUE(says(CommandRefusal::kNotFinite, "not finite"));
  EXPECT_TRUE(says(CommandRefusal::kExpired, "older than its validity"));
  EXPECT_TRUE(says(CommandRefusal::kOldSequence, "not above the last"));
  EXPECT_TRUE(says(CommandRefusal::kRingFull, "send fewer"));
  EXPECT_TRUE(says(CommandRefusal::kUnknownModule, "rc10ctl modules"));
  EXPECT_TRUE(says(CommandRefusal::kUnknownSignal, "no input of that name"));
  EXPECT_TRUE(says(CommandRefusal::kUnusedField, "does not use"));
  EXPECT_TRUE(says(CommandRefusal::kNotPermitted, "`clients`"));
  EXPECT_TRUE(says(CommandRefusal::kGainsBeyondDrive, "stiffness or damping"));
}

TEST_F(AdmissionTest, TheNameOfAReasonIsItsCounters) {
  using enum CommandRefusal;
  for (const auto& [refusal, name] : {std::pair{kNone, "accepted"},
                                      {kMalformed, "malformed"},
                                      {kUnknownMotor, "unknown motor"},
                                      {kUnknownMode, "unknown mode"},
                                      {kUnsupportedMode, "unsupported mode"},
                                      {kNotFinite, "not finite"},
                                      {kExpired, "expired"},
                                      {kOldSequence, "old sequence"},
                                      {kRingFull, "too many commands"},
                                      {kUnknownModule, "unknown module"},
                                      {kUnknownSignal, "unknown signal"},
                                      {kUnusedField, "unused field"},
                                      {kNotPermitted, "not permitted"},
                                      {kGainsBeyondDrive, "gains beyond drive"}})
    EXPECT_STREQ(toString(refusal), name);
}

TEST_F(AdmissionTest, EveryClientHasASequenceOfItsOwn) {
  auto message = linkCommand(100, now, {setpoint("left", kVelocity)});
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
  message.client = "remote";
  message.seq = 1;
  EXPECT_EQ(admit(message), CommandRefusal::kNone);
}

TEST_F(AdmissionTest, ATableFullOfClientsStillKnowsTheirSequences) {
  speaker.way = Speaker::Way::kLcm;
  auto message = linkCommand(1, now, {setpoint("left", kVelocity)});
  for (int i = 0; i < 64; ++i) {
    message.client = "client " + std::to_string(i);
    ASSERT_EQ(admit(message), CommandRefusal::kNone);
  }
  EXPECT_EQ(admit(message), CommandRefusal::kOldSequence);
}

TEST_F(AdmissionTest, AFloodOfClientNamesIsSurvived) {
  speaker.way = Speaker::Way::kLcm;
  auto message = linkCommand(1, now, {setpoint("left", kVelocity)});
  for (int i = 0; i < 1000; ++i) {
    message.client = "client " + std::to_string(i);
    ASSERT_EQ(admit(message), CommandRefusal::kNone);
  }
}

TEST_F(AdmissionTest, CountsRefusalsByReason) {
  admission.count(CommandRefusal::kExpired);
  admission.count(CommandRefusal::kExpired);
  admission.count(CommandRefusal::kNone);
  EXPECT_EQ(admission.counts()[static_cast<std::size_t>(CommandRefusal::kExpired)], 2U);
  EXPECT_EQ(admission.counts()[static_cast<std::size_t>(CommandRefusal::kNone)], 1U);
  EXPECT_EQ(admission.counts()[static_cast<std::size_t>(CommandRefusal::kMalformed)], 0U);
}

TEST_F(AdmissionTest, NamesTheMotorAndTheModeForWhichAMessageIsRefused) {
  EXPECT_EQ(
      admit(linkCommand(++seq, now, {setpoint("left", kVelocity, 1.0), setpoint("right", kAngle, 1.0)})),
      CommandRefusal::kUnsupportedMode);
  EXPECT_EQ(admission.culprit(), "right: angle");
  EXPECT_EQ(admit(one(setpoint("lift", kVelocity, 1.0))), CommandRefusal::kUnknownMotor);
  EXPECT_EQ(admission.culprit(), "lift");
  EXPECT_EQ(admit(good()), CommandRefusal::kNone);
  EXPECT_EQ(admission.culprit(), "");
}

}  // namespace
}  // namespace rc10::test::admission_test
