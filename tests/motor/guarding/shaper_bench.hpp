#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "motor/guarding/target_shaper.hpp"

namespace rc10::test {

/// A shaper, and a shaft of which the tests say where it is.
class TargetShaperTest : public ::testing::Test {
 protected:
  static constexpr float kTickS = 0.001F;

  TargetShaperTest() {
    feedback.samples = 1;
    feedback.zeroed = true;
    feedback.velocity_rpm = 0.0F;
    at(0.0);
  }
  void at(double total_angle_deg) {
    feedback.total_angle_deg = total_angle_deg;
    feedback.angle_deg = static_cast<float>(total_angle_deg - 360.0 * std::floor(total_angle_deg / 360.0));
  }
  void configure(const ShapingConfig& config) { shaper = TargetShaper{config}; }
  struct Shaped {
    Target target;
    std::uint32_t limits = 0;
  };
  Shaped step(Target target, TargetShaper::InForce in_force = {0.0F, CommandUnit::kAmpere}) {
    const auto limits = shaper.step(target, feedback, in_force, kTickS);
    return {target, limits};
  }
  Shaped step(ControlMode mode, double value, float amperes = 0.0F) {
    return step(Target{.mode = mode, .value = value}, {amperes, CommandUnit::kAmpere});
  }
  double valueAfter(int ticks, ControlMode mode, double value) {
    double last = 0.0;
    for (int i = 0; i < ticks; ++i) last = step(mode, value).target.value;
    return last;
  }

  MotorFeedback feedback;
  TargetShaper shaper{ShapingConfig{}};
  const ShapingConfig soft{.angle_min_deg = -90.0,
                           .angle_max_deg = 90.0,
                           .approach_rpm_per_deg = 2.0F,
                           .approach_effort_per_rpm = 0.2F};
};

}  // namespace rc10::test
