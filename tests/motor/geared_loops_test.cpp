#include "motor/geared_loops.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace rc10::test::geared_loops_test {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

CascadeConfig everyField() {
  return {.velocity = PID_Position::Config{.kp = 1.0F,
                                           .ki = 2.0F,
                                           .kd = 3.0F,
                                           .integral_limit = 4.0F,
                                           .integral_separation = 5.0F,
                                           .deadband = 6.0F,
                                           .output_limit = 7.0F,
                                           .derivative_filter_hz = 8.0F},
          .angle = {.kp = 1.0F,
                    .ki = 2.0F,
                    .kd = 3.0F,
                    .integral_limit = 4.0F,
                    .integral_separation = kInfinite,
                    .deadband = 6.0F,
                    .output_limit = 7.0F,
                    .derivative_filter_hz = 8.0F},
          .velocity_limit_rpm = 9.0F};
}

TEST(GearedLoops, EffortsAndFrequenciesStaySpeedsAndAnglesAreThoseOfTheShaft) {
  const auto loops = loopsBehindGear(everyField(), 2.0);
  const auto& velocity = std::get<PID_Position::Config>(loops.velocity);
  EXPECT_EQ(velocity.kp, 2.0F);
  EXPECT_EQ(velocity.ki, 4.0F);
  EXPECT_EQ(velocity.kd, 6.0F);
  EXPECT_EQ(velocity.integral_limit, 4.0F) << "A";
  EXPECT_EQ(velocity.integral_separation, 2.5F);
  EXPECT_EQ(velocity.deadband, 3.0F);
  EXPECT_EQ(velocity.output_limit, 7.0F) << "A";
  EXPECT_EQ(velocity.derivative_filter_hz, 8.0F);
  EXPECT_EQ(loops.angle.kp, 1.0F) << "rpm and degrees of one shaft";
  EXPECT_EQ(loops.angle.ki, 2.0F);
  EXPECT_EQ(loops.angle.kd, 3.0F);
  EXPECT_EQ(loops.angle.integral_limit, 2.0F);
  EXPECT_EQ(loops.angle.integral_separation, kInfinite);
  EXPECT_EQ(loops.angle.deadband, 3.0F);
  EXPECT_EQ(loops.angle.output_limit, 3.5F);
  EXPECT_EQ(loops.angle.derivative_filter_hz, 8.0F);
  EXPECT_EQ(loops.velocity_limit_rpm, 4.5F);
}

TEST(GearedLoops, AnIncrementalLoopIsScaledAlike) {
  auto loops = everyField();
  loops.velocity =
      PID_Incremental::Config{.kp = 1.0F, .ki = 2.0F, .kd = 3.0F, .deadband = 4.0F, .tracking_rad_s = 5.0F};
  loops = loopsBehindGear(loops, 0.5);
  const auto& velocity = std::get<PID_Incremental::Config>(loops.velocity);
  EXPECT_EQ(velocity.kp, 0.5F);
  EXPECT_EQ(velocity.ki, 1.0F);
  EXPECT_EQ(velocity.kd, 1.5F);
  EXPECT_EQ(velocity.deadband, 8.0F);
  EXPECT_EQ(velocity.tracking_rad_s, 5.0F);
}

}  // namespace
}  // namespace rc10::test::geared_loops_test
