#include "motor/guarding/target_shaper.hpp"

#include <gtest/gtest.h>

#include "motor/guarding/shaper_bench.hpp"

namespace rc10::test::target_shaper_stiffness_test {
namespace {

TEST_F(TargetShaperTest, AnImpedanceWithoutStiffnessIsAtNoPlace) {
  configure({.angle_slew_deg_per_s = 100.0F, .max_first_step_deg = 30.0});
  Target target{.mode = ControlMode::kImpedance, .value = 300.0};
  EXPECT_TRUE(shaper.firstStepAllowed(target, {}, feedback));
  for (int i = 0; i < 5000; ++i) (void)step(target);
  target.stiffness_nm_per_rad = 100.0F;
  EXPECT_FALSE(shaper.firstStepAllowed(target, {}, feedback));
  EXPECT_NEAR(step(target).target.value, 0.1, 1e-6) << "from where the shaft is";
}

TEST_F(TargetShaperTest, AnImpedanceThatIsHardlyStiffIsHardlyAtAPlace) {
  configure({.angle_slew_deg_per_s = 100.0F, .max_first_step_deg = 30.0});
  const Target soft_spring{.mode = ControlMode::kImpedance, .value = 300.0, .stiffness_nm_per_rad = 0.01F};
  for (int i = 0; i < 5000; ++i) (void)step(soft_spring);
  Target spring = soft_spring;
  spring.stiffness_nm_per_rad = 100.0F;
  EXPECT_FALSE(shaper.firstStepAllowed(spring, soft_spring, feedback));
  EXPECT_TRUE(shaper.firstStepAllowed(spring, spring, feedback));
  spring.value = 29.0;
  EXPECT_TRUE(shaper.firstStepAllowed(spring, soft_spring, feedback));
  for (const auto mode : {ControlMode::kAngle, ControlMode::kTotalAngle}) {
    const Target angle{.mode = mode, .value = mode == ControlMode::kAngle ? -60.0 : 300.0};
    EXPECT_FALSE(shaper.firstStepAllowed(angle, soft_spring, feedback)) << "a loop is as stiff as can be";
    EXPECT_TRUE(shaper.firstStepAllowed(angle, angle, feedback));
    EXPECT_TRUE(shaper.firstStepAllowed({.mode = mode, .value = 29.0}, soft_spring, feedback));
  }
  spring.value = 300.0;
  EXPECT_NEAR(step(spring).target.value, 0.13, 1e-6) << "with the torque of before, and a tick of its slew";
}

TEST_F(TargetShaperTest, AStiffnessThatRisesInStepsLeadsNoFartherThanAFirstStep) {
  configure({.max_first_step_deg = 180.0});
  Target spring{.mode = ControlMode::kImpedance, .value = 300.0, .stiffness_nm_per_rad = 0.01F};
  Target stiffer = spring;
  for (; spring.stiffness_nm_per_rad < 100.0F; spring = stiffer) {
    stiffer.stiffness_nm_per_rad *= 1.2F;
    EXPECT_FALSE(shaper.firstStepAllowed(stiffer, spring, feedback)) << spring.stiffness_nm_per_rad;
    stiffer.value = 170.0;
    EXPECT_TRUE(shaper.firstStepAllowed(stiffer, spring, feedback)) << spring.stiffness_nm_per_rad;
    stiffer.value = 300.0;
  }
}

TEST_F(TargetShaperTest, AStiffnessThatRisesPullsNoHarderThanTheSlewOfItsPlace) {
  for (const int ticks : {1, 10, 200}) {
    configure({.angle_slew_deg_per_s = 100.0F});
    Target spring{.mode = ControlMode::kImpedance, .value = 300.0, .stiffness_nm_per_rad = 0.01F};
    double before = 0.0;
    for (int i = 0; i < 5000; ++i) before = 0.01 * step(spring).target.value;
    for (int i = 1; i <= ticks; ++i) {
      spring.stiffness_nm_per_rad = 0.01F + 100.0F * static_cast<float>(i) / static_cast<float>(ticks);
      const double pull = static_cast<double>(spring.stiffness_nm_per_rad) * step(spring).target.value;
      EXPECT_LE(pull, before + 0.1 * static_cast<double>(spring.stiffness_nm_per_rad) + 1e-6);
      before = pull;
    }
  }
}

TEST_F(TargetShaperTest, AStiffnessThatRisesInASoftStartPullsNoHarder) {
  configure({.soft_start_s = 0.2F});
  shaper.restart();
  Target spring{.mode = ControlMode::kImpedance, .value = 100.0, .stiffness_nm_per_rad = 0.1F};
  for (int i = 0; i < 100; ++i) (void)step(spring);
  spring.stiffness_nm_per_rad = 10.0F;
  EXPECT_LT(step(spring).target.value, 1.6);
}

TEST_F(TargetShaperTest, AStiffnessThatFallsOrStaysLeavesThePlace) {
  configure({.angle_slew_deg_per_s = 100.0F});
  Target spring{.mode = ControlMode::kImpedance, .value = 10.0, .stiffness_nm_per_rad = 10.0F};
  for (int i = 0; i < 500; ++i) (void)step(spring);
  spring.stiffness_nm_per_rad = 5.0F;
  EXPECT_EQ(step(spring).target.value, 10.0);
  EXPECT_EQ(step(spring).target.value, 10.0);
}

// It has sagged beyond the soft limit meanwhile.
TEST_F(TargetShaperTest, AStiffnessThatComesBeyondASoftLimitBeginsThere) {
  ShapingConfig config = soft;
  config.angle_slew_deg_per_s = 100.0F;
  configure(config);
  Target target{.mode = ControlMode::kImpedance};
  (void)step(target);
  at(-110.0);
  (void)step(target);
  target.stiffness_nm_per_rad = 100.0F;
  EXPECT_NEAR(step(target).target.value, -109.9, 1e-6);
  EXPECT_NEAR(step(target).target.value, -109.8, 1e-6);
}

}  // namespace
}  // namespace rc10::test::target_shaper_stiffness_test
