// A load that drives a shaft too fast is a fault in every family with a no-load speed of its own, also
// beyond a field of the speed that wraps.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "daemon/one_motor_robot.hpp"
#include "daemon/virtual_robot.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "drives/damiao/damiao_model.hpp"

namespace rc10::test::overspeed_test {
namespace {

/// Keys of motors that are watched without a key.
std::vector<std::string> watchedMotors() {
  std::vector<std::string> motors{"model: M3508, id: 1",
                                  "model: M2006, id: 1",
                                  "model: GM6020, id: 2",
                                  "model: AK80-9, id: 5",
                                  "model: RMD-X8-20, id: 11",
                                  "model: RMD-X6-7, id: 11",
                                  "model: RMD-X6-8, id: 11",
                                  "model: moteus, id: 7, motor_kv_rpm_per_v: 100",
                                  "model: RS00, id: 3, overspeed_rpm: 300"};
  for (const auto& model : cubemarsModels()) {
    const std::string name{model.name};
    motors.push_back("model: " + name + ", id: 5, protocol: " + (model.v3 ? "mit_v3" : "mit"));
  }
  for (const auto& model : damiaoModels()) {
    if (model.no_load_rpm > 0.0F)
      motors.push_back("model: " + std::string{model.name} + ", id: 1, master_id: 17");
  }
  return motors;
}

class Overspeed : public ::testing::TestWithParam<std::string> {};

TEST_P(Overspeed, IsAFaultInBothDirections) {
  for (const double sign : {1.0, -1.0}) {
    const auto config = oneMotorRobot(GetParam());
    const auto& motor = config.buses.at(0).motors.at(0);
    VirtualRobot robot{config};
    auto& drive = robot.simBus().drive(0);
    for (int i = 0; i < 2000 && robot.motor(0).status != MotorStatus::kReady; ++i) robot.run(1);
    (void)robot.order(Operation::kEnable);
    ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
    const auto traits = motor.traits();
    const double full_nm = static_cast<double>(traits.effort_full_scale * traits.torque_nm_per_a);
    const double most_rpm = static_cast<double>(motor.guard.overspeed_rpm);
    sim::MotorLoad load;
    load.load_torque_nm = static_cast<float>(-sign * 4.0 * full_nm);
    // A tenth of a second to the no-load speed.
    load.inertia_kg_m2 = static_cast<float>(full_nm / most_rpm);
    drive.setLoad(load);
    double fastest_rpm = 0.0;
    for (int i = 0; i < 5000 && robot.motor(0).status == MotorStatus::kActive; ++i) {
      fastest_rpm = std::max(fastest_rpm, std::abs(drive.physics().outputRpm()));
      robot.hold(0, {.mode = ControlMode::kCurrent}, 1);
    }
    EXPECT_EQ(robot.motor(0).fault, FaultCode::kOverspeed);
    EXPECT_GT(fastest_rpm, 0.99 * most_rpm);
    EXPECT_GT(sign * static_cast<double>(robot.motor(0).feedback.velocity_rpm), 0.99 * most_rpm);
  }
}

INSTANTIATE_TEST_SUITE_P(Motors, Overspeed, ::testing::ValuesIn(watchedMotors()), [](const auto& each) {
  std::string name = each.param.substr(7, each.param.find(',') - 7) + "_" + std::to_string(each.index);
  for (auto& letter : name) {
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  }
  return name;
});

}  // namespace
}  // namespace rc10::test::overspeed_test
