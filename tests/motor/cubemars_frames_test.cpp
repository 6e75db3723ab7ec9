#include <chrono>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "motor/cubemars_bench.hpp"

namespace rc10::test::cubemars_frames_test {
namespace {

using namespace cubemars_bench;

// --- codec ---------------------------------------------------------------------------------------------

TEST(CubemarsFrames, MitCommandsKeepTheirValuesToOneStep) {
  std::mt19937 random(99);
  for (const auto& model : cubemarsModels()) {
    const auto settings =
        cubemarsSettings(model.name, 9, {{"protocol", std::string{model.v3 ? "mit_v3" : "mit"}}});
    const Mit bench(settings);
    const auto& r = model.ranges;
    const auto any = [&random](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int i = 0; i < 500; ++i) {
      const SpringLaw wanted{.position_rad = any(-r.position_rad, r.position_rad),
                             .velocity_rad_s = any(-r.velocity_rad_s, r.velocity_rad_s),
                             .stiffness_nm_per_rad = any(0, 500),
                             .damping_nms_per_rad = any(0, 5),
                             .torque_nm = any(-r.torque_nm, r.torque_nm)};
      const auto got =
          bench.decode(model.v3 ? cubemars::mitV3Frame(9, r, wanted) : cubemars::mitFrame(9, r, wanted));
      ASSERT_NEAR(got.position_rad, wanted.position_rad, 2.01 * r.position_rad / 65535);
      ASSERT_NEAR(got.velocity_rad_s, wanted.velocity_rad_s, 2.01 * r.velocity_rad_s / 4095);
      ASSERT_NEAR(got.stiffness_nm_per_rad, wanted.stiffness_nm_per_rad, 500.1 / 4095);
      ASSERT_NEAR(got.damping_nms_per_rad, wanted.damping_nms_per_rad, 5.01 / 4095);
      ASSERT_NEAR(got.torque_nm, wanted.torque_nm, 2.01 * r.torque_nm / 4095);
    }
  }
}

TEST(CubemarsFrames, WhatIsTooMuchIsCutOffAndNeverWraps) {
  const double huge = 1e300;
  EXPECT_EQ(int32Of(cubemars::dutyFrame(1, huge)), 100'000);
  EXPECT_EQ(int32Of(cubemars::currentFrame(1, -huge)), -60'000);
  EXPECT_EQ(int32Of(cubemars::brakeFrame(1, -huge)), 0);
  EXPECT_EQ(int32Of(cubemars::velocityFrame(1, huge)), 100'000);
  EXPECT_EQ(int32Of(cubemars::positionFrame(1, huge)), 360'000'000);
  const auto planned = cubemars::positionVelocityFrame(1, -huge, huge, huge);
  EXPECT_EQ(int32Of(planned), -360'000'000);
  EXPECT_EQ(readBigEndian<std::int16_t>(planned.payload(), 4), 32767);
  EXPECT_EQ(readBigEndian<std::int16_t>(planned.payload(), 6), 32767);
  EXPECT_EQ(int32Of(cubemars::currentFrame(1, std::nan(""))), 0);
  const CubemarsRanges r = cubemarsModels()[0].ranges;
  const auto high = cubemars::mitFrame(1, r, {huge, huge, huge, huge, huge});
  const auto low = cubemars::mitFrame(1, r, {-huge, -huge, -huge, -huge, -huge});
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(high.data[i], 0xFF);
    EXPECT_EQ(low.data[i], 0x00);
  }
}

TEST(Cubemars, GarbageLeavesFiniteReadings) {
  std::mt19937 random(5);
  Servo servo_bench(servo());
  Mit mit_bench(mit());
  for (int i = 0; i < 20'000; ++i) {
    CanFrame frame;
    frame.length = static_cast<std::uint8_t>(random() % 9U);
    for (std::size_t k = 0; k < 8; ++k) frame.data[k] = static_cast<std::uint8_t>(random());
    frame.received = MonotonicTime{std::chrono::hours{1}} + std::chrono::microseconds{i * 500};
    frame.id = {0x2905, true};
    (void)servo_bench.motor().updateFeedback(frame);
    frame.id = {0, false};
    frame.data[0] = 5;
    if (mit_bench.motor().matchesFrame(frame)) (void)mit_bench.motor().updateFeedback(frame);
  }
  for (const auto* motor : {static_cast<const SoloMotor*>(&servo_bench.motor()),
                            static_cast<const SoloMotor*>(&mit_bench.motor())}) {
    const auto& feedback = motor->feedback();
    EXPECT_GT(feedback.samples, 0U);
    EXPECT_TRUE(std::isfinite(feedback.total_angle_deg));
    EXPECT_TRUE(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
    EXPECT_TRUE(std::isfinite(feedback.velocity_rpm) && std::isfinite(feedback.current_a));
  }
}

}  // namespace
}  // namespace rc10::test::cubemars_frames_test
