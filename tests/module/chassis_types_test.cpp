// Values of a chassis that its types refuse.
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "fake_robot.hpp"
#include "module/chassis.hpp"
#include "module/chassis_values.hpp"
#include "module/swerve_chassis.hpp"

namespace rc10::test::chassis_types_test {
namespace {

using ::testing::HasSubstr;

TEST(ChassisTypes, RefuseAMotorTwiceAndOnesThatTakeNoVelocities) {
  ModuleSettings settings;
  settings.own = common();
  auto wheels = section({"front_left", "front_right", "rear_left", "rear_right"});
  wheels.set("rear_left", 0.0);
  settings.own.set("wheels", std::vector{wheels});
  EXPECT_EQ(mecanumChassisType().build(settings, outlineOf(4)).error().message,
            "wheels.rear_left: motor 'motor0' is given twice");
  auto robot = outlineOf(4);
  robot.motors[1].modes = ModeSet{ControlMode::kCurrent};
  EXPECT_THAT(mecanumChassisType().build(settings, robot).error().message,
              HasSubstr("wheels.front_right: motor 'motor1' takes no velocity targets"));
}

TEST(ChassisTypes, APowerLimitNeedsTheTorqueOfEachMotor) {
  const auto corners = [](std::size_t first) {
    return std::vector{section({"front_left", "front_right", "rear_left", "rear_right"}, first)};
  };
  ModuleSettings settings;
  settings.own = common();
  settings.own.set("wheels", corners(0));
  settings.own.set("drive", corners(0));
  settings.own.set("steer", corners(4));
  auto robot = outlineOf(8);
  robot.motors[2].unreported_torque_remedy = "write kv_rpm_per_v";
  EXPECT_TRUE(mecanumChassisType().build(settings, robot)) << "it has no limit";
  settings.own.set("power_limit_w", 80.0);
  const std::string refusal =
      "reports no torque, of which the power is computed: the limit would never act; write kv_rpm_per_v, or "
      "remove it";
  EXPECT_EQ(mecanumChassisType().build(settings, robot).error().message,
            "power_limit_w: motor 'motor2' " + refusal);
  EXPECT_EQ(swerveChassisType().build(settings, robot).error().message,
            "power_limit_w: motor 'motor2' " + refusal);
  std::swap(robot.motors[2].unreported_torque_remedy, robot.motors[7].unreported_torque_remedy);
  EXPECT_TRUE(mecanumChassisType().build(settings, robot));
  EXPECT_EQ(swerveChassisType().build(settings, robot).error().message,
            "power_limit_w: motor 'motor7' " + refusal);
}

TEST(ChassisTypes, ALimitOfTheWheelsMustComeFromSomewhere) {
  ModuleSettings settings;
  settings.own = common();
  settings.own.set("wheels", std::vector{section({"front_left", "front_right", "rear_left", "rear_right"})});
  auto robot = outlineOf(4);
  for (auto& motor : robot.motors) motor.velocity_limit_rpm = 0.0F;
  EXPECT_THAT(mecanumChassisType().build(settings, robot).error().message,
              HasSubstr("wheel_limit_rpm: is missing"));
}

}  // namespace
}  // namespace rc10::test::chassis_types_test
