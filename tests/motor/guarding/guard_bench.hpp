#pragma once

#include <chrono>

#include <gtest/gtest.h>

#include "motor/guarding/motor_guard.hpp"

namespace rc10::test::guard_bench {

using namespace std::chrono_literals;

class MotorGuardTest : public ::testing::Test {
 protected:
  static MotorFeedback seen(float velocity_rpm, float temperature_c) {
    MotorFeedback feedback;
    feedback.velocity_rpm = velocity_rpm;
    feedback.temperature_c = temperature_c;
    return feedback;
  }
  /// One sample and one tick, a millisecond later.
  MotorGuard::Verdict step(std::uint32_t limits = 0) {
    ++feedback.samples;
    now += 1ms;
    return look(limits);
  }
  /// One tick without a new sample.
  MotorGuard::Verdict tickOnly() {
    now += 1ms;
    return look(0);
  }
  MotorGuard::Verdict look(std::uint32_t limits) {
    return guard.step({.feedback = feedback,
                       .target = target,
                       .effort = effort_a,
                       .unit = unit,
                       .limits = limits,
                       .now = now});
  }

  MonotonicTime now{1000s};
  MotorFeedback feedback = seen(100.0F, 30.0F);
  Target target;
  float effort_a = 0.0F;
  CommandUnit unit = CommandUnit::kAmpere;
  MotorGuard guard{{.overspeed_rpm = 700.0F,
                    .temperature_derate_c = 80.0F,
                    .temperature_trip_c = 100.0F,
                    .stall_time = 200ms,
                    .stall_rpm = 10.0F}};
};

class MotionGuardTest : public MotorGuardTest {
 protected:
  MotionGuardTest() {
    guard = MotorGuard{{.following_error_deg = 15.0,
                        .following_error_time = 100ms,
                        .encoder_jumps = true,
                        .frozen_a = 1.0F,
                        .runaway_rpm = 48.0F}};
    feedback.current_a = 0.0F;
    feedback.total_angle_deg = 0.0;
  }
  /// Runs this number of samples; returns the first fault.
  FaultCode run(int samples, std::uint32_t limits = 0) {
    for (int i = 0; i < samples; ++i) {
      if (const auto fault = step(limits).fault; fault != FaultCode::kNone) return fault;
    }
    return FaultCode::kNone;
  }
  /// The same at its current limit with this speed.
  FaultCode atLimit(float velocity_rpm, int samples) {
    feedback.velocity_rpm = velocity_rpm;
    return run(samples, kLimitCurrent);
  }
};

}  // namespace rc10::test::guard_bench
