#pragma once

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::fallback_bench {

constexpr std::size_t kLeft = 0;
constexpr Target kVelocity120{.mode = ControlMode::kVelocity, .value = 120.0};

/// A simulated robot whose left wheel turns at 120 rpm.
class FallbackBench : public ::testing::Test {
 protected:
  void start(const FallbackConfig& fallback, float load_torque_nm = 0.0F, const GuardConfig& guard = {}) {
    auto config = twoWheelsAndYaw();
    config.buses[0].motors[kLeft].guard = guard;
    config.buses[0].motors[kLeft].fallback = fallback;
    config.buses[0].motors[kLeft].shaping.soft_start_s = 0.2F;
    config.buses[0].motors[kLeft].simulated.load_torque_nm = load_torque_nm;
    robot = std::make_unique<VirtualRobot>(config);
    robot->run(5);
    robot->order(Operation::kEnable);
    robot->hold(kLeft, kVelocity120, 1000);
    ASSERT_NEAR(rpm(), 120.0F, 3.0F);
  }
  float rpm() { return robot->motor(kLeft).feedback.velocity_rpm; }
  float currentA() { return robot->motor(kLeft).command_value; }
  double angleDeg() { return robot->motor(kLeft).feedback.total_angle_deg; }
  /// Ticks until it stands still.
  int ticksToStop() {
    for (int i = 0; i < 20'000; ++i) {
      robot->tick();
      if (std::fabs(rpm()) < 2.0F) return i;
    }
    return 20'000;
  }

  void estop() { robot->exchange().estop.store(true); }
  /// It is asked to be enabled, and so many ticks pass.
  void enableFor(int ticks) {
    robot->beginEnabling(MotorSet{}.set(kLeft));
    robot->run(ticks);
  }
  void expectAtRest() {
    EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
    EXPECT_EQ(robot->motor(kLeft).acting, Acting::kNothing);
  }

  std::unique_ptr<VirtualRobot> robot;
};

}  // namespace rc10::test::fallback_bench
