#include "motor/motor_base.hpp"

#include <limits>
#include <string_view>

#include <gtest/gtest.h>

#include "drives/dji/dji_motor.hpp"

namespace rc10::test::motor_base_test {
namespace {

using namespace rc10::literals;

// The users' firmware passes milliamperes and rpm as bare numbers: that must not compile here.
template <typename Motor>
concept TakesBareNumbers = requires(Motor& motor) { motor.setTargetCurrent(500); } ||
                           requires(Motor& motor) { motor.setTargetRPM(3.0); } ||
                           requires(Motor& motor) { motor.setTargetAngle(90.0F); } ||
                           requires(Motor& motor) { motor.setTargetTotalAngle(720); };
template <typename Motor>
concept MixesUnits = requires(Motor& motor) { motor.setTargetCurrent(Rpm{5.0}); } || requires(Motor& motor) {
  motor.setTargetRPM(Amperes{5.0});
} || requires(Motor& motor) { motor.setTargetAngle(Rpm{5.0}); };
template <typename Motor>
concept TakesQuantities = requires(Motor& motor) {
  motor.setTargetCurrent(500_mA);
  motor.setTargetCurrent(0.5_A);
  motor.setTargetRPM(120_rpm);
  motor.setTargetAngle(90_deg);
  motor.setTargetTotalAngle(720_deg);
};
static_assert(!TakesBareNumbers<Motor_Base>);
static_assert(!MixesUnits<Motor_Base>);
static_assert(TakesQuantities<Motor_Base>);

M3508 wheel() {
  MotorSettings settings;
  settings.name = "wheel";
  settings.id = 1;
  settings.loops = kM3508.current.default_loops;
  return M3508{settings};
}

TEST(MotorBase, QuantitiesBecomeTargetsInTheProjectsUnits) {
  M3508 motor = wheel();
  EXPECT_TRUE(motor.setTargetCurrent(500_mA));
  EXPECT_EQ(motor.target().mode, ControlMode::kCurrent);
  EXPECT_DOUBLE_EQ(motor.target().value, 0.5);
  EXPECT_TRUE(motor.setTargetRPM(120_rpm));
  EXPECT_EQ(motor.target().mode, ControlMode::kVelocity);
  EXPECT_TRUE(motor.setTargetAngle(-90_deg));
  EXPECT_EQ(motor.target().mode, ControlMode::kAngle);
  EXPECT_TRUE(motor.setTargetTotalAngle(720_deg));
  EXPECT_EQ(motor.target().mode, ControlMode::kTotalAngle);
  EXPECT_DOUBLE_EQ(motor.target().value, 720.0);
}

TEST(MotorBase, RefusesAModeTheMotorLacksAndKeepsTheOldTarget) {
  M3508 motor = wheel();
  ASSERT_TRUE(motor.setTargetRPM(50_rpm));
  for (const auto mode : {ControlMode::kVoltage, ControlMode::kDuty, ControlMode::kImpedance}) {
    EXPECT_FALSE(motor.setTarget({.mode = mode, .value = 1.0})) << toString(mode);
  }
  EXPECT_FALSE(motor.setTarget({.mode = static_cast<ControlMode>(200), .value = 1.0}));
  EXPECT_EQ(motor.target().mode, ControlMode::kVelocity);
  EXPECT_DOUBLE_EQ(motor.target().value, 50.0);
}

TEST(MotorBase, RefusesNumbersThatAreNotFinite) {
  M3508 motor = wheel();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(motor.setTargetRPM(Rpm{kNan}));
  EXPECT_FALSE(motor.setTargetCurrent(Amperes{std::numeric_limits<double>::infinity()}));
  EXPECT_FALSE(motor.setTarget({.mode = ControlMode::kVelocity,
                                .value = 1.0,
                                .torque_ff_nm = std::numeric_limits<float>::infinity()}));
  EXPECT_EQ(motor.target().mode, ControlMode::kCoast);
  EXPECT_TRUE(motor.setTarget({.mode = ControlMode::kBrake, .value = kNan}));  // has no value
  EXPECT_DOUBLE_EQ(motor.target().value, 0.0);
}

TEST(MotorBase, AFeedForwardThatIsNotGivenIsZero) {
  M3508 motor = wheel();
  EXPECT_TRUE(motor.setTarget({.mode = ControlMode::kVelocity,
                               .value = 1.0,
                               .velocity_ff_rpm = kNotReported,
                               .torque_ff_nm = kNotReported}));
  EXPECT_FLOAT_EQ(motor.target().velocity_ff_rpm, 0.0F);
  EXPECT_FLOAT_EQ(motor.target().torque_ff_nm, 0.0F);
}

TEST(MotorBase, RestsUntilOrderedOtherwise) {
  M3508 motor = wheel();
  EXPECT_EQ(motor.ordered(), FrameKind::kRest);
  EXPECT_EQ(motor.target().mode, ControlMode::kCoast);
}

TEST(ControlMode, EveryModeHasItsOwnName) {
  for (int a = 0; a < kControlModeCount; ++a) {
    const std::string_view name = toString(static_cast<ControlMode>(a));
    EXPECT_NE(name, "unknown");
    for (int b = 0; b < a; ++b) EXPECT_NE(name, toString(static_cast<ControlMode>(b)));
  }
  EXPECT_STREQ(toString(static_cast<ControlMode>(99)), "unknown");
}

TEST(ModeSet, ContainsWhatItWasMadeOf) {
  constexpr ModeSet kSet{ControlMode::kCoast, ControlMode::kBrake};
  static_assert(kSet.contains(ControlMode::kCoast) && kSet.contains(ControlMode::kBrake));
  static_assert(!kSet.contains(ControlMode::kCurrent) && !ModeSet{}.contains(ControlMode::kCoast));
}

TEST(ModeSet, OfTwoHasTheModesThatAreInBoth) {
  constexpr ModeSet kSome{ControlMode::kCoast, ControlMode::kVelocity, ControlMode::kDuty};
  constexpr ModeSet kOthers{ControlMode::kVelocity, ControlMode::kDuty, ControlMode::kBrake};
  static_assert((kSome & kOthers).bits() == ModeSet{ControlMode::kVelocity, ControlMode::kDuty}.bits());
  static_assert((kSome & ModeSet{}).bits() == 0);
}

}  // namespace
}  // namespace rc10::test::motor_base_test
