#pragma once

#include <cstdint>
#include <vector>

#include "app/vocabulary.hpp"

namespace rc10::client {

/// One tick of a motor under test.
struct CurveSample {
  double time_s = 0.0;  ///< Since the target of the test was first in force.
  double target = 0.0;
  double target_shaped = 0.0;  ///< Within the motor's limits and slew: what its loop follows.
  double measured = 0.0;       ///< In the unit of the target.
  double total_angle_deg = 0.0;
  double velocity_rpm = 0.0;
  double current_a = 0.0;
  double feedback_age_us = 0.0;
  std::uint32_t limits = 0;
};

using Curve = std::vector<CurveSample>;

/// The reading that follows a target of this mode; 0: none does.
[[nodiscard]] inline double CurveSample::*measuredMember(ControlMode mode) noexcept {
  switch (mode) {
    case ControlMode::kCurrent: return &CurveSample::current_a;
    case ControlMode::kVelocity: return &CurveSample::velocity_rpm;
    case ControlMode::kTotalAngle: return &CurveSample::total_angle_deg;
    default: return nullptr;
  }
}

}  // namespace rc10::client
