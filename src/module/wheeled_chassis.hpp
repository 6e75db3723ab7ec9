#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "app/wheel_speeds.hpp"
#include "module/chassis_base.hpp"

namespace rc10 {

/// Between two ticks no wheel turns this many times faster than it can be told to: an angle that has jumped
/// (a new reference, a restarted drive) is no way that was travelled.
inline constexpr double kImpossibleSpeed = 3.0;

/// The multi-turn angles of wheels, for the way that they have travelled from tick to tick.
class WheelTravel {
 public:
  WheelTravel(std::size_t wheels, double limit_rpm) : last_deg_(wheels, kNoSignal), limit_rpm_(limit_rpm) {}

  /// Mean speed since the last call. Where the angle is not known or has jumped: the measured velocity.
  [[nodiscard]] double meanRpm(std::size_t wheel, const MotorFeedback& feedback, float dt_s) noexcept {
    const double rpm = rc10::meanRpm(last_deg_[wheel], feedback.total_angle_deg, dt_s);
    last_deg_[wheel] = feedback.total_angle_deg;
    // Samples do not come in step with ticks: one with two of them shows twice the speed.
    const bool possible = std::isfinite(rpm) && std::fabs(rpm) <= kImpossibleSpeed * limit_rpm_;
    return possible ? rpm : static_cast<double>(feedback.velocity_rpm);
  }

 private:
  std::vector<double> last_deg_;
  double limit_rpm_;
};

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
        travel_(kCount, limit_rpm) {}

 protected:
  void drive(const Twist2D& body, ModuleRobot& robot) noexcept override {
    Wheels speeds = limited(kinematics_.inverse(body), limit_rpm_);
    for (std::size_t i = 0; i < kCount; ++i) {
      robot.setTarget(wheels_[i], {.mode = ControlMode::kVelocity, .value = speeds.*Wheels::kAll[i]});
    }
  }

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
  WheelTravel travel_;
};

}  // namespace rc10
