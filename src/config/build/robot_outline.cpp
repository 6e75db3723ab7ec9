#include "config/build/robot_outline.hpp"

namespace rc10 {

RobotOutline outlineOf(const RobotConfig& robot) {
  RobotOutline outline;
  outline.tick_hz = robot.rate_hz;
  for (const auto& bus : robot.buses) {
    for (const auto& motor : bus.motors) {
      const auto traits = motor.traits();
      const double gear_ratio = gearRatioOf(motor.settings, traits);
      const auto no_load_rpm =
          static_cast<float>(static_cast<double>(traits.no_load_rpm) * traits.gear_ratio / gear_ratio);
      const float limit_rpm = motor.settings.velocity_limit_rpm;
      outline.motors.push_back(
          {.name = motor.name(),
           .modes = traits.modes,
           .velocity_limit_rpm = limit_rpm > 0.0F ? limit_rpm : no_load_rpm,
           .current_limit_a = traits.effort == CommandUnit::kAmpere
                                  ? effortLimitOf(motor.settings, traits.effort_full_scale)
                                  : 0.0F,
           .angle_min_deg = motor.shaping.angle_min_deg,
           .angle_max_deg = motor.shaping.angle_max_deg,
           .current_period = currentPeriodOf(motor.settings, traits),
           .unreported_current_remedy = traits.unreported_current_remedy,
           .unreported_torque_remedy = traits.unreported_torque_remedy});
    }
  }
  return outline;
}

}  // namespace rc10
