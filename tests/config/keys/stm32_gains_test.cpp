#include "config/keys/stm32_gains.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::stm32_gains_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// ---- the formulas of the users' library, as its public documents and sources give them

/// Its speed loop: a step each tick, without a dt. Outputs mA.
class TickPid {
 public:
  explicit TickPid(const Stm32Pid& pid) : pid_(pid) {}
  double step(double target, double measured) {
    double e = target - measured;
    if (std::abs(e) < pid_.deadband) e = 0.0;
    if (!first_) output_ += pid_.kp * (e - e1_) + pid_.ki * e + pid_.kd * (e - 2.0 * e1_ + e2_);
    first_ = false;
    output_ = std::clamp(output_, -pid_.output_limit, pid_.output_limit);
    e2_ = e1_;
    e1_ = e;
    return output_;
  }

 private:
  Stm32Pid pid_;
  double e1_ = 0.0;
  double e2_ = 0.0;
  double output_ = 0.0;
  bool first_ = true;
};

/// Its angle loop. Outputs rpm.
class SecondsPid {
 public:
  SecondsPid(const Stm32Pid& pid, double separation) : pid_(pid), separation_(separation) {}
  double step(double target, double measured, double dt_s) {
    double e = target - measured;
    if (std::abs(e) < pid_.deadband) e = 0.0;
    if (separation_ > 0.0 && std::abs(e) < separation_) {
      integral_ += pid_.ki * (e + e1_) * dt_s / 2.0;
      if (pid_.limits_integral) integral_ = std::clamp(integral_, -pid_.integral_limit, pid_.integral_limit);
    } else {
      integral_ = 0.0;
    }
    const double d = pid_.kd * (measured - measured1_) / dt_s;
    e1_ = e;
    measured1_ = measured;
    return std::clamp(pid_.kp * e + integral_ - d, -pid_.output_limit, pid_.output_limit);
  }

 private:
  Stm32Pid pid_;
  double separation_;
  double e1_ = 0.0;
  double integral_ = 0.0;
  double measured1_ = 0.0;
};

// A shaft that starts at rest and wanders, the same for both.
class Wander {
 public:
  explicit Wander(double size) : size_(size) {}
  double next() {
    velocity_ = 0.95 * velocity_ + noise_(random_) * size_;
    value_ += velocity_;
    return value_;
  }

 private:
  double size_;
  double velocity_ = 0.0;
  double value_ = 0.0;
  std::mt19937 random_{7};
  std::normal_distribution<double> noise_;
};

constexpr double kTick_s = 0.001;

TEST(SpeedGains, BothControllersAskForTheSameCurrent) {
  const Stm32Pid pid{.kp = 18.0, .ki = 0.015, .output_limit = 15'000.0, .deadband = 5.0};
  TickPid theirs(pid);
  PID_Incremental ours(convertSpeedGains(pid, 0.0, kTick_s).config);
  Wander shaft(0.5);
  bool limited = false;
  (void)theirs.step(0.0, 0.0);
  (void)ours.step(0.0F, 0.0F, static_cast<float>(kTick_s));
  for (int tick = 1; tick < 5000; ++tick) {
    const double target = tick < 2000 ? 60.0 : -120.0;
    const double measured = shaft.next();
    const double expected_a = theirs.step(target, measured) / 1000.0;
    const auto got_a = ours.step(static_cast<float>(target), static_cast<float>(measured), 0.001F);
    // At the limit theirs loses a little effort to the noise of the speed.
    limited |= std::fabs(expected_a) > 14.99;
    ASSERT_NEAR(static_cast<double>(got_a), expected_a, limited ? 0.15 : 0.003) << "tick " << tick;
  }
}

TEST(SpeedGains, TheDerivativeIsTheSameWhileTheTargetStands) {
  const Stm32Pid pid{.kp = 18.0, .ki = 0.015, .kd = 40.0, .output_limit = 15'000.0};
  TickPid theirs(pid);
  PID_Incremental ours(convertSpeedGains(pid, 0.0, kTick_s).config);
  Wander shaft(0.5);
  // Both have forgotten how they began after three steps at rest.
  for (int i = 0; i < 3; ++i) {
    (void)theirs.step(0.0, 0.0);
    (void)ours.step(0.0F, 0.0F, 0.001F);
  }
  for (int tick = 0; tick < 2000; ++tick) {
    const double measured = shaft.next();
    const double expected_a = theirs.step(0.0, measured) / 1000.0;
    const auto got_a = ours.step(0.0F, static_cast<float>(measured), 0.001F);
    ASSERT_NEAR(static_cast<double>(got_a), expected_a, 0.005) << "tick " << tick;
  }
}

TEST(SpeedGains, TheLengthOfTheTickCounts) {
  const Stm32Pid pid{.kp = 18.0, .ki = 0.03, .kd = 4.0, .output_limit = 10'000.0};
  const auto config = convertSpeedGains(pid, 3.0, 0.002).config;
  EXPECT_FLOAT_EQ(config.kp, 0.018F);
  EXPECT_FLOAT_EQ(config.ki, 0.015F);
  EXPECT_FLOAT_EQ(config.kd, 8e-6F);
  EXPECT_FLOAT_EQ(config.output_limit, 10.0F);
  EXPECT_FLOAT_EQ(config.tracking_rad_s, 3.0F);
}

TEST(AngleGains, BothControllersAskForTheSameSpeed) {
  const Stm32Pid pid{.kp = 30.0,
                     .ki = 4.0,
                     .kd = 1.1,
                     .integral_limit = 50.0,
                     .limits_integral = true,
                     .output_limit = 400.0,
                     .deadband = 0.8};
  constexpr double kSeparation_deg = 20.0;
  constexpr double kPeriod_s = 0.01;
  SecondsPid theirs(pid, kSeparation_deg);
  PID_Position ours(convertAngleGains(pid, kSeparation_deg).config);
  Wander shaft(0.01);  // stays within the separation, where both integrate
  for (int step = 0; step < 2000; ++step) {
    const double measured = step == 0 ? 0.0 : shaft.next();
    const double expected_rpm = theirs.step(3.0 * std::sin(step * 0.01), measured, kPeriod_s);
    const auto got_rpm = ours.step(static_cast<float>(3.0 * std::sin(step * 0.01)),
                                   static_cast<float>(measured), static_cast<float>(kPeriod_s));
    ASSERT_NEAR(static_cast<double>(got_rpm), expected_rpm, 0.05) << "step " << step;
  }
}

TEST(AngleGains, AnIntegralThatNeverActedStaysAway) {
  const Stm32Pid pid{.kp = 30.0, .ki = 4.0, .output_limit = 400.0};
  EXPECT_EQ(convertAngleGains(pid, 0.0).config.ki, 0.0F);
  EXPECT_THAT(convertAngleGains(pid, 0.0).notes, Contains(HasSubstr("I_SeparaThreshold 0")));
  Stm32Pid bounded = pid;
  bounded.limits_integral = true;
  EXPECT_EQ(convertAngleGains(bounded, 10.0).config.ki, 0.0F);
  EXPECT_EQ(convertAngleGains(pid, 10.0).config.ki, 4.0F);
}

TEST(Stm32Pid, IsReadAsTheFirmwareWritesIt) {
  const std::vector<std::string> numbers{"18.0f", "0.015f", "0.f", "8000.0f", "true", "15000.0f", "5"};
  const auto pid = stm32Pid(numbers);
  ASSERT_TRUE(pid) << pid.error().message;
  EXPECT_EQ(pid->kp, 18.0);
  EXPECT_EQ(pid->ki, 0.015);
  EXPECT_TRUE(pid->limits_integral);
  EXPECT_EQ(pid->integral_limit, 8000.0);
  EXPECT_EQ(pid->output_limit, 15'000.0);
  EXPECT_EQ(pid->deadband, 5.0);
}

TEST(Stm32Pid, WhatIsNoNumberIsRefused) {
  for (const auto* bad : {"f", "", "1e", "-1", "nan", "x"}) {
    const std::vector<std::string> numbers{"1", bad, "0"};
    EXPECT_FALSE(stm32Pid(numbers)) << bad;
  }
  const std::vector<std::string> two{"1", "2"};
  EXPECT_THAT(stm32Pid(two).error().message, HasSubstr("kp ki kd I_Outlimit"));
}

TEST(YamlLines, AreThoseOfAConfiguration) {
  const Stm32Pid pid{.kp = 18.0, .ki = 0.015, .output_limit = 15'000.0, .deadband = 5.0};
  EXPECT_EQ(yamlLines(namedGains(convertSpeedGains(pid, 0.0, kTick_s))),
            "current_limit_a: 15\n"
            "velocity_pid:\n"
            "  type: incremental\n"
            "  kp_a_per_rpm: 0.018\n"
            "  ki_a_per_rpm_s: 0.015  # per second\n"
            "  kd_a_s_per_rpm: 0\n"
            "  deadband_rpm: 5\n");
  EXPECT_EQ(yamlLines(namedGains(
                convertAngleGains({.kp = 30.0, .kd = 1.1, .output_limit = 400.0, .deadband = 0.8}, 0.0))),
            "angle_pid:\n"
            "  kp_rpm_per_deg: 30\n"
            "  ki_rpm_per_deg_s: 0\n"
            "  kd_rpm_s_per_deg: 1.1\n"
            "  deadband_deg: 0.8\n"
            "  velocity_limit_rpm: 400\n");
  EXPECT_THAT(yamlLines(namedGains(convertSpeedGains({.kp = 1.0}, 2.0, kTick_s))),
              HasSubstr("target_bandwidth_rad_s: 2"));
  EXPECT_THAT(yamlLines(namedGains(convertSpeedGains({.kp = 1.0}, 2.0, kTick_s))),
              Not(HasSubstr("current_limit_a: ")));
}

TEST(NamedGains, HaveTheKeysOfAMotorAndTheNotesApart) {
  const auto named = namedGains(convertSpeedGains({.kp = 18.0, .kd = 1.0}, 0.0, kTick_s));
  EXPECT_EQ(named.section, "velocity_pid");
  EXPECT_EQ(named.gains.front().key, "kp_a_per_rpm");
  EXPECT_FLOAT_EQ(named.gains.front().value, 0.018F);
  EXPECT_EQ(named.notes.size(), 2U);
}

}  // namespace
}  // namespace rc10::stm32_gains_test
