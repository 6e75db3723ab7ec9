#include "motor/speed_scale_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "app/units.hpp"

namespace rc10::test::speed_scale_check_test {
namespace {

using namespace std::chrono_literals;
using Verdict = SpeedScaleCheck::Verdict;

/// A steady speed for this time, with a sample each millisecond.
void turn(SpeedScaleCheck& check, MonotonicTime& now, double& angle_deg, double rpm, double reported_rpm,
          Duration duration) {
  for (const auto end = now + duration; now < end; now += 1ms) {
    angle_deg += rpm * kDegPerSPerRpm * 1e-3;
    check.add(now, angle_deg, reported_rpm);
  }
}

TEST(SpeedScaleCheck, AFewTenthsOfASecondAtASteadySpeedDecide) {
  for (const double rpm : {30.0, -30.0, 400.0}) {
    SpeedScaleCheck check;
    MonotonicTime now{1h};
    double angle_deg = 0.0;
    turn(check, now, angle_deg, rpm, rpm, 250ms);
    EXPECT_EQ(check.verdict(), Verdict::kOpen);
    turn(check, now, angle_deg, rpm, rpm, 100ms);
    EXPECT_EQ(check.verdict(), Verdict::kAgrees);
  }
}

// RobStride's sample against its manuals: RS00 50 for 33 rad/s, RS03 50 for 20, RS05 33 for 50, RS06 20 for
// 50; RS01 taken for RS00; AK80-9 taken for AK80-6.
TEST(SpeedScaleCheck, AnotherScaleIsToldFromTheOwn) {
  for (const double ratio : {33.0 / 50.0, 20.0 / 50.0, 50.0 / 33.0, 50.0 / 20.0, 44.0 / 33.0, 50.0 / 76.0}) {
    for (const double rpm : {60.0, -60.0, 20.0}) {
      SpeedScaleCheck check;
      MonotonicTime now{1h};
      double angle_deg = 1e6;
      turn(check, now, angle_deg, rpm, ratio * rpm, 500ms);
      EXPECT_EQ(check.verdict(), Verdict::kWrong) << ratio << " at " << rpm;
      EXPECT_NEAR(check.ratio(), ratio, 0.02 * ratio);
    }
  }
}

TEST(SpeedScaleCheck, OnceKnownItIsNotAskedAgainUntilItIsReset) {
  SpeedScaleCheck check;
  MonotonicTime now{1h};
  double angle_deg = 0.0;
  turn(check, now, angle_deg, 60.0, 60.0, 1s);
  turn(check, now, angle_deg, 60.0, 120.0, 1s);
  EXPECT_EQ(check.verdict(), Verdict::kAgrees);
  check.reset();
  EXPECT_EQ(check.verdict(), Verdict::kOpen);
  turn(check, now, angle_deg, 60.0, 120.0, 1s);
  EXPECT_EQ(check.verdict(), Verdict::kWrong);
}

TEST(SpeedScaleCheck, WithoutMotionThereIsNoVerdict) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double reported_rpm : {0.0, 1.0, kNaN, kInfinity}) {
    SpeedScaleCheck check;
    MonotonicTime now{1h};
    double angle_deg = 0.0;
    turn(check, now, angle_deg, 3.0, reported_rpm, 10s);
    turn(check, now, angle_deg, kNaN, 60.0, 10s);
    EXPECT_EQ(check.verdict(), Verdict::kOpen) << reported_rpm;
  }
}

TEST(SpeedScaleCheck, AnAngleThatStandsAtTheEndOfItsScaleOrRunsBackwardsIsNotJudged) {
  for (const double true_rpm : {0.0, 5.0, -60.0}) {
    SpeedScaleCheck check;
    MonotonicTime now{1h};
    double angle_deg = 0.0;
    turn(check, now, angle_deg, true_rpm, 60.0, 10s);
    EXPECT_EQ(check.verdict(), Verdict::kOpen) << true_rpm;
  }
}

TEST(SpeedScaleCheck, TimesThatRunBackwardsOrStandStillAreNotJudged) {
  SpeedScaleCheck check;
  MonotonicTime now{1h};
  for (int i = 0; i < 10'000; ++i) check.add(i % 2 == 0 ? now : now - 5ms, i, 60.0);
  for (int i = 0; i < 10'000; ++i) check.add(now, i, 60.0);
  EXPECT_EQ(check.verdict(), Verdict::kOpen);
}

/// A motor and its mechanics as badly as healthy ones come, and the drive's readings of them.
class Rough {
 public:
  explicit Rough(unsigned seed) : random_(seed) {
    period_ms_ = std::array{1, 2, 5, 10, 20}[random_() % 5];
    lag_s_ = uniform(0.0, 0.03);
    noise_rpm_ = uniform(0.0, 6.0);
    backlash_deg_ = uniform(0.0, 3.0);
    loss_ = uniform(0.0, 0.2);
    slip_ = random_() % 2 == 0 ? uniform(0.0, 2e-3) : 0.0;
    jitter_s_ = uniform(0.0, 0.005);
    full_rpm_ = uniform(80.0, 720.0);
    reach_deg_ = random_() % 3 == 0 ? uniform(20.0, 200.0) : 1e9;
    acceleration_ = uniform(100.0, 20'000.0);
  }

  /// `ratio` of the reported speed to the true one.
  void run(SpeedScaleCheck& check, double ratio, double seconds) {
    for (int ms = 0; ms < static_cast<int>(seconds * 1e3); ++ms) {
      step();
      if (ms % period_ms_ != 0 || uniform(0.0, 1.0) < loss_) continue;
      if (uniform(0.0, 1.0) < slip_) slipped_deg_ += uniform(-40.0, 40.0);
      const double lsb_rpm = 2.0 * full_rpm_ / 4095.0;
      const double seen_rpm = ratio * filtered_rpm_ + std::normal_distribution{0.0, 1.0}(random_)*noise_rpm_;
      const double reported_rpm = (std::floor(seen_rpm / lsb_rpm) + 0.5) * lsb_rpm;
      const double lsb_deg = 1432.4 / 65535.0;
      const double angle_deg = std::floor((output_deg_ + slipped_deg_) / lsb_deg) * lsb_deg;
      const auto late =
          std::chrono::duration_cast<Duration>(std::chrono::duration<double>(uniform(0.0, jitter_s_)));
      stamp_ = std::max(stamp_, now_ + late);
      check.add(stamp_, angle_deg, reported_rpm);
    }
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution{low, high}(random_); }

  void step() {
    now_ += 1ms;
    if (uniform(0.0, 1.0) < 1e-3)
      target_rpm_ = random_() % 4 == 0 ? 0.0 : uniform(-1.0, 1.0) * 0.8 * full_rpm_;
    if (random_() % 3000 == 0) dither_ = !dither_;
    const double wanted_rpm =
        target_rpm_ + (dither_ ? 0.2 * full_rpm_ * std::sin(0.1 * static_cast<double>(++phase_)) : 0.0);
    const double most_rpm = acceleration_ * 1e-3;
    rpm_ += std::clamp(wanted_rpm - rpm_, -most_rpm, most_rpm);
    rotor_deg_ += rpm_ * kDegPerSPerRpm * 1e-3;
    if (std::abs(rotor_deg_) > reach_deg_) {  // a stop
      rotor_deg_ = std::copysign(reach_deg_, rotor_deg_);
      rpm_ = 0.0;
      target_rpm_ = -target_rpm_;
    }
    output_deg_ = std::clamp(output_deg_, rotor_deg_ - 0.5 * backlash_deg_, rotor_deg_ + 0.5 * backlash_deg_);
    filtered_rpm_ += (rpm_ - filtered_rpm_) * 1e-3 / (lag_s_ + 1e-3);
  }

  std::mt19937 random_;
  int period_ms_ = 1;
  double lag_s_ = 0.0, noise_rpm_ = 0.0, backlash_deg_ = 0.0, loss_ = 0.0, slip_ = 0.0, jitter_s_ = 0.0;
  double full_rpm_ = 0.0, reach_deg_ = 0.0, acceleration_ = 0.0;
  MonotonicTime now_{1h};
  MonotonicTime stamp_{};
  double target_rpm_ = 0.0, rpm_ = 0.0, filtered_rpm_ = 0.0;
  double rotor_deg_ = 0.0, output_deg_ = 0.0, slipped_deg_ = 0.0;
  bool dither_ = false;
  int phase_ = 0;
};

TEST(SpeedScaleCheck, AHealthyMotorIsNeverFoundWrong) {
  int agreed = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    Rough motor(seed);
    // As after each enabling: it has to be right again and again.
    for (int enabling = 0; enabling < 4; ++enabling) {
      SpeedScaleCheck check;
      motor.run(check, 1.0, 5.0);
      ASSERT_NE(check.verdict(), Verdict::kWrong) << "seed " << seed << ", ratio " << check.ratio();
      agreed += check.verdict() == Verdict::kAgrees ? 1 : 0;
    }
  }
  EXPECT_GT(agreed, 300) << "half of 600";
}

TEST(SpeedScaleCheck, AWrongScaleIsFoundInTheSameNoiseAndNeverTakenForRight) {
  for (const double ratio : {0.4, 0.66, 1.5, 2.5}) {
    int found = 0;
    for (unsigned seed = 0; seed < 50; ++seed) {
      Rough motor(seed);
      SpeedScaleCheck check;
      motor.run(check, ratio, 15.0);
      EXPECT_NE(check.verdict(), Verdict::kAgrees) << "seed " << seed << ", ratio " << ratio;
      found += check.verdict() == Verdict::kWrong ? 1 : 0;
    }
    EXPECT_GT(found, 20) << ratio;
  }
}

}  // namespace
}  // namespace rc10::test::speed_scale_check_test
