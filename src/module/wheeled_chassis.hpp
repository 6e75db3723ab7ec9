#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "app/wheel_speeds.hpp"
#include "module/chassis_base.hpp"
#include "module/shared_limit.hpp"

namespace rc10 {

/// Between two samples no wheel turns this many times faster than it can be told to: an angle that has jumped
/// (a new reference, a restarted drive) is no way that was travelled.
inline constexpr double kImpossibleSpeed = 3.0;

/// Multi-turn angles of wheels, for the way that they have travelled from sample to sample. Samples come when
/// they come, or are lost: the whole way since the last one counts in the tick of the next.
class WheelTravel {
 public:
  WheelTravel(std::size_t wheels, double limit_rpm) : last_(wheels), limit_rpm_(limit_rpm) {}

  /// Way since the sample of the last call, as a mean speed over dt; 0 without a new one. Where the angle is
  /// not known or has jumped: by the measured velocity.
  [[nodiscard]] double meanRpm(std::size_t wheel, const MotorFeedback& feedback, float dt_s) noexcept {
    const Sample last = last_[wheel];
    if (feedback.samples == last.samples) return 0.0;
    last_[wheel] = {feedback.total_angle_deg, feedback.received, feedback.samples};
    // Stamps jitter: two samples of one tick may lie closer together than the drive took them.
    const float between_s =
        last.samples == 0 ? dt_s : std::max(dt_s, seconds(feedback.received - last.received));
    const double share = static_cast<double>(between_s) / static_cast<double>(dt_s);
    const double rpm = rc10::meanRpm(last.angle_deg, feedback.total_angle_deg, between_s);
    const bool possible = std::isfinite(rpm) && std::fabs(rpm) <= kImpossibleSpeed * limit_rpm_;
    // After a long silence the present velocity says nothing about the time before.
    return possible ? rpm * share : static_cast<double>(feedback.velocity_rpm) * std::min(share, kMostTicks);
  }

 private:
  struct Sample {
    double angle_deg = kNoSignal;
    MonotonicTime received{};
    std::uint64_t samples = 0;
  };
  static constexpr double kMostTicks = 10.0;

  std::vector<Sample> last_;
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
  WheelTravel travel_;
};

}  // namespace rc10
