#pragma once

#include <array>
#include <cstddef>

#include "module/chassis_base.hpp"
#include "module/shared_limit.hpp"
#include "module/travel_of_motors.hpp"

namespace rc10 {

/// A chassis whose wheels have fixed directions: mecanum, omni, differential. `Wheels` names them,
/// `Kinematics` computes with them.
template <typename Kinematics, typename Wheels>
class WheeledChassis final : public Chassis_Base {
 public:
  static constexpr std::size_t kCount = Wheels::kAll.size();

  WheeledChassis(const OwnValues& own, const Kinematics& kinematics,
                 const std::array<std::size_t, kCount>& wheels, double limit_rpm)
      : Chassis_Base(own, {wheels.begin(), wheels.end()}),
        kinematics_(kinematics),
        wheels_(wheels),
        limit_rpm_(limit_rpm),
        drives_sideways_(kinematics.forward(kinematics.inverse({.vy_m_s = 1.0})).vy_m_s > 0.5),
        travel_(kCount, limit_rpm) {}

 protected:
  void drive(const Twist2D& body, ModuleRobot& robot) noexcept override {
    Wheels speeds = limited(kinematics_.inverse(body), sharedLimitRpm(robot, wheels_, limit_rpm_));
    for (std::size_t i = 0; i < kCount; ++i) {
      robot.setTarget(wheels_[i], {.mode = ControlMode::kVelocity, .value = speeds.*Wheels::kAll[i]});
    }
  }

  [[nodiscard]] bool drivesSideways() const noexcept override { return drives_sideways_; }

  [[nodiscard]] Twist2D measured(const ModuleRobot& robot) const noexcept override {
    return forward(
        [&](std::size_t i) { return static_cast<double>(robot.feedback(wheels_[i]).velocity_rpm); });
  }

  [[nodiscard]] Twist2D travelled(const ModuleRobot& robot, float dt_s) noexcept override {
    return forward([&](std::size_t i) { return travel_.meanRpm(i, robot.feedback(wheels_[i]), dt_s); });
  }

 private:
  template <typename SpeedOf>
  [[nodiscard]] Twist2D forward(SpeedOf speed_of) const noexcept {
    Wheels speeds;
    for (std::size_t i = 0; i < kCount; ++i) speeds.*Wheels::kAll[i] = speed_of(i);
    return kinematics_.forward(speeds);
  }

  Kinematics kinematics_;
  std::array<std::size_t, kCount> wheels_;
  double limit_rpm_;
  bool drives_sideways_;
  TravelOfMotors travel_;
};

}  // namespace rc10
