// Soft limits of a motor whose samples or commands lie far apart.
#include "motor/guarding/target_shaper.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "motor/guarding/shaper_bench.hpp"

namespace rc10::test::target_shaper_spacing_test {
namespace {

using namespace std::chrono_literals;

struct Spacing {
  const char* name;
  int feedback_ms;
  int command_ms;
  int gap_ms = 0;  ///< So long no sample comes, once it is near the limit.
};

void PrintTo(const Spacing& spacing, std::ostream* out) { *out << spacing.name; }

/// A shaft that does at once what it is told, and says so seldom.
class SpacedShaft : public TargetShaperTest, public ::testing::WithParamInterface<Spacing> {
 protected:
  void start(double direction) {
    const auto& spacing = GetParam();
    ShapingConfig config = soft;
    config.feedback_period_s = 0.001F * static_cast<float>(spacing.feedback_ms);
    config.command_period_s = 0.001F * static_cast<float>(spacing.command_ms);
    configure(config);
    shaft_deg = -80.0 * direction;
    told_rpm = farthest_deg = 0.0;
    silent_until = 0;
    was_silent = false;
    hear();
  }
  void hear() {
    at(shaft_deg);
    feedback.velocity_rpm = static_cast<float>(told_rpm);
    feedback.received = now;
    ++feedback.samples;
  }
  void run(double rpm, int ticks) {
    const int command_ms = GetParam().command_ms;
    silent_until = 0;
    for (int i = 1; i <= ticks; ++i) {
      now += 1ms;
      shaft_deg += 0.006 * told_rpm;
      farthest_deg = std::max(farthest_deg, std::fabs(shaft_deg));
      if (!was_silent && std::fabs(shaft_deg) < 40.0) {
        silent_until = i + GetParam().gap_ms;
        was_silent = true;
      }
      if (i % GetParam().feedback_ms == 0 && i >= silent_until) hear();
      shaper.reckon(feedback, now);
      const double shaped_rpm = step(ControlMode::kVelocity, rpm).target.value;
      // Between two samples: one of them is old already.
      if ((i + 3 * command_ms / 8) % command_ms == 0) told_rpm = shaped_rpm;
    }
  }

  MonotonicTime now{1000s};
  double shaft_deg = 0.0;
  double told_rpm = 0.0;
  double farthest_deg = 0.0;
  int silent_until = 0;
  bool was_silent = false;
};

TEST_P(SpacedShaft, StopsAtTheLimit) {
  for (const double direction : {1.0, -1.0}) {
    for (const double rpm : {20.0, 200.0, 2000.0}) {
      SCOPED_TRACE(direction * rpm);
      start(direction);
      run(direction * rpm, 20'000);
      EXPECT_LT(farthest_deg, 90.01);
      EXPECT_GT(farthest_deg, 89.0) << "and not before";
      run(-direction * rpm, 3000);
      EXPECT_LT(shaft_deg * direction, 60.0) << "back it always goes";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Spacings, SpacedShaft,
                         ::testing::Values(Spacing{"Quick", 1, 1}, Spacing{"TenHertz", 100, 1},
                                           Spacing{"FiveHertz", 200, 1}, Spacing{"OneHertz", 1000, 1},
                                           Spacing{"SeldomTold", 1, 100}, Spacing{"Answers", 100, 100},
                                           Spacing{"QuickWithAGap", 1, 1, 350},
                                           Spacing{"TenHertzWithAGap", 100, 1, 390},
                                           Spacing{"FiveHertzWithAGap", 200, 1, 790}),
                         [](const auto& spacing) { return std::string{spacing.param.name}; });

TEST_F(TargetShaperTest, QuickSamplesLeaveTheApproachAsItIs) {
  ShapingConfig config = soft;
  config.feedback_period_s = 0.02F;
  config.command_period_s = 0.02F;
  configure(config);
  at(80.0);
  EXPECT_DOUBLE_EQ(step(ControlMode::kVelocity, 500.0).target.value, 20.0);
  config.feedback_period_s = 0.1F;
  config.command_period_s = 0.0F;
  configure(config);
  EXPECT_NEAR(step(ControlMode::kVelocity, 500.0).target.value, 8.333, 1e-3) << "half of the way in a period";
}

// Gains that are tried out do not lift the bound.
TEST_F(TargetShaperTest, GainsOfTheLoopsStayWithinTheSpacing) {
  ShapingConfig config = soft;
  config.feedback_period_s = 0.1F;
  configure(config);
  shaper.setGains(100.0F, 0.1F);
  at(80.0);
  EXPECT_NEAR(step(ControlMode::kVelocity, 500.0).target.value, 8.333, 1e-3);
  shaper.setGains(1.0F, 0.1F);
  EXPECT_NEAR(step(ControlMode::kVelocity, 500.0).target.value, 5.0, 1e-3);
}

}  // namespace
}  // namespace rc10::test::target_shaper_spacing_test
