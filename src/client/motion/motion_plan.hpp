#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/vocabulary.hpp"
#include "client/motion/excitation.hpp"
#include "client/motion/motion_run.hpp"

namespace rc10::client {

/// A test as a person asks for it: what is left out has a default that depends on the rest.
struct MotionPlan {
  std::string motor;
  ExcitationKind kind = ExcitationKind::kStep;
  ControlMode mode = ControlMode::kVelocity;
  double amplitude = 0.0;
  double base = 0.0;
  std::optional<double> time_s = {};      ///< 1.5 s; sines ten periods of the lowest frequency, 10 to 120 s.
  std::optional<double> rate_per_s = {};  ///< Slope of a ramp.
  double from_hz = 1.0;
  double to_hz = 20.0;
  bool linear = false;
  double max_current_a = 0.0;
  std::optional<double> max_speed_rpm = {};  ///< Velocity: half of the amplitude beyond the target.
  std::optional<double> min_angle_deg = {};  ///< Total angle: the same; else none.
  std::optional<double> max_angle_deg = {};
  double max_feedback_age_s = 0.2;
  bool stop_at_limits = false;
  std::int32_t dead_man_ms = 200;
};

/// The settings of the plan; `client`: name under which the targets are sent. The error says why the test
/// must not begin, whatever the robot.
[[nodiscard]] Result<MotionSettings> settingsOf(const MotionPlan& plan, const std::string& client);

}  // namespace rc10::client
