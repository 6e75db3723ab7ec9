// A target after enabling, of a motor whose fallback holds a load.
#include <limits>

#include <gtest/gtest.h>

#include "app/units.hpp"
#include "motor/guarding/shaper_bench.hpp"

namespace rc10::test::target_shaper_held_test {
namespace {

/// Held at 30 deg by 6 N·m, which is 12 A; it has sunk to 25 deg.
class TargetShaperHeldTest : public TargetShaperTest {
 protected:
  static constexpr TargetShaper::InForce kHeld{
      .value = 12.0F, .unit = CommandUnit::kAmpere, .held_deg = 30.0};
  static constexpr double kHeldNm = 6.0;

  TargetShaperHeldTest() {
    at(25.0);
    configure({});
  }
  void configure(ShapingConfig config) {
    config.effort_per_nm = 2.0F;
    config.springs = true;
    TargetShaperTest::configure(config);
    shaper.restart();
  }
  /// First of a target after enabling.
  Target first(const Target& target) { return step(target, kHeld).target; }
  /// Torque of an impedance at the angle where the shaft is.
  [[nodiscard]] double torqueNm(const Target& told) const {
    return static_cast<double>(told.stiffness_nm_per_rad) * (told.value - feedback.total_angle_deg) *
               kRadPerDeg +
           static_cast<double>(told.torque_ff_nm);
  }
};

TEST_F(TargetShaperHeldTest, ASoftStartOfAnAngleBeginsWhereTheShaftIsHeld) {
  configure({.soft_start_s = 0.1F});
  EXPECT_NEAR(first({.mode = ControlMode::kTotalAngle, .value = 130.0}).value, 31.0, 1e-3);
  configure({.soft_start_s = 0.1F});
  EXPECT_NEAR(first({.mode = ControlMode::kAngle, .value = 130.0}).value, 31.0, 1e-3);
}

TEST_F(TargetShaperHeldTest, ASlewOfAnAngleBeginsThereToo) {
  configure({.angle_slew_deg_per_s = 1000.0F});
  EXPECT_NEAR(first({.mode = ControlMode::kTotalAngle, .value = 130.0}).value, 31.0, 1e-3);
}

TEST_F(TargetShaperHeldTest, ALimitOfTheAngleHoldsForTheHeldOne) {
  configure({.angle_slew_deg_per_s = 1000.0F, .angle_min_deg = -90.0, .angle_max_deg = 27.0});
  EXPECT_LE(first({.mode = ControlMode::kTotalAngle, .value = 130.0}).value, 30.0);
  for (int i = 0; i < 10; ++i) (void)step({.mode = ControlMode::kTotalAngle, .value = 130.0});
  EXPECT_NEAR(step({.mode = ControlMode::kTotalAngle, .value = 130.0}).target.value, 27.0, 1e-6);
}

TEST_F(TargetShaperHeldTest, AnImpedanceBeginsWithTheTorqueInForceWhateverItsStiffness) {
  for (const float stiffness_nm_per_rad : {0.0F, 1.0F, 60.0F, 500.0F}) {
    configure({.soft_start_s = 0.1F});
    const Target asked{.mode = ControlMode::kImpedance,
                       .value = 25.0,
                       .stiffness_nm_per_rad = stiffness_nm_per_rad,
                       .damping_nms_per_rad = 1.0F};
    const Target told = first(asked);
    EXPECT_NEAR(torqueNm(told), 0.99 * kHeldNm, 1e-3) << stiffness_nm_per_rad;
    EXPECT_LE(told.value, 30.0) << "no farther than the held angle";
    for (int i = 0; i < 48; ++i) (void)step(asked);
    EXPECT_NEAR(torqueNm(step(asked).target), 0.5 * kHeldNm, 1e-3);
    for (int i = 0; i < 50; ++i) (void)step(asked);
    EXPECT_NEAR(torqueNm(step(asked).target), 0.0, 1e-6) << "nothing was asked for";
  }
}

TEST_F(TargetShaperHeldTest, TheSpringOfAnImpedanceGivesThatTorqueAsFarAsItCan) {
  const auto begun = [&](float stiffness_nm_per_rad) {
    configure({.soft_start_s = 1000.0F});
    return first(
        {.mode = ControlMode::kImpedance, .value = 25.0, .stiffness_nm_per_rad = stiffness_nm_per_rad});
  };
  EXPECT_NEAR(begun(500.0F).value, 25.0 + kHeldNm / 500.0 / kRadPerDeg, 1e-3);
  EXPECT_NEAR(begun(500.0F).torque_ff_nm, 0.0F, 1e-3F);
  EXPECT_NEAR(begun(60.0F).value, 30.0, 1e-3) << "no farther than the held angle";
}

TEST_F(TargetShaperHeldTest, AFeedForwardThatHoldsTheLoadTakesItOverWithoutAGap) {
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kImpedance}) {
    configure({.soft_start_s = 0.1F});
    const double place = mode == ControlMode::kImpedance ? 25.0 : 0.0;
    const Target asked{.mode = mode, .value = place, .torque_ff_nm = 6.0F};
    EXPECT_NEAR(first(asked).torque_ff_nm, 6.0F, 1e-3F);
    for (int i = 0; i < 200; ++i) EXPECT_NEAR(step(asked).target.torque_ff_nm, 6.0F, 1e-3F);
  }
}

TEST_F(TargetShaperHeldTest, ASlewOfTheEffortLetsItGoAtItsRate) {
  configure({.effort_slew_per_s = 100.0F});
  const Target asked{.mode = ControlMode::kVelocity};
  EXPECT_NEAR(first(asked).torque_ff_nm, 5.95F, 1e-4F);
  EXPECT_NEAR(step(asked).target.torque_ff_nm, 5.90F, 1e-4F);
}

// The integral of a loop holds the load already.
TEST_F(TargetShaperHeldTest, AVelocityLoopGetsNothingBesides) {
  TargetShaperTest::configure({.effort_per_nm = 2.0F, .soft_start_s = 0.1F});
  shaper.restart();
  EXPECT_EQ(first({.mode = ControlMode::kVelocity}).torque_ff_nm, 0.0F);
}

// A position loop of the drive holds the load, and tells its current.
TEST_F(TargetShaperHeldTest, AnImpedanceBeginsWithTheMeasuredTorqueWhereTheDriveHolds) {
  const Target asked{.mode = ControlMode::kImpedance, .value = 25.0, .stiffness_nm_per_rad = 50.0F};
  const TargetShaper::InForce native{.value = 30.0F, .unit = CommandUnit::kNative, .held_deg = 30.0};
  for (const float current_a : {-8.0F, 12.0F}) {
    configure({.soft_start_s = 0.1F});
    feedback.current_a = current_a;
    EXPECT_NEAR(torqueNm(step(asked, native).target), 0.99 * static_cast<double>(current_a) / 2.0, 1e-3);
  }
  configure({.soft_start_s = 0.1F});
  feedback.current_a = std::numeric_limits<float>::quiet_NaN();
  const auto unknown = step(asked, native).target;
  EXPECT_EQ(unknown.torque_ff_nm, 0.0F);
  EXPECT_NEAR(unknown.value, 25.0, 1e-6);
  configure({.soft_start_s = 0.1F});
  feedback.current_a = 12.0F;
  EXPECT_EQ(step({.mode = ControlMode::kVelocity}, native).target.torque_ff_nm, 0.0F) << "its own loop";
}

TEST_F(TargetShaperHeldTest, WhatIsNotHeldBeginsFromWhatIsMeasured) {
  configure({.soft_start_s = 0.1F});
  const auto told =
      step({.mode = ControlMode::kTotalAngle, .value = 125.0}, {.value = 12.0F, .unit = CommandUnit::kAmpere})
          .target;
  EXPECT_NEAR(told.value, 26.0, 1e-3);
  EXPECT_EQ(told.torque_ff_nm, 0.0F);
}

TEST_F(TargetShaperHeldTest, AWeightThatComesAsAFeedForwardIsHeldWhateverItsSlew) {
  configure({.effort_slew_per_s = 5.0F, .soft_start_s = 0.2F});
  const Target asked{.mode = ControlMode::kImpedance,
                     .value = 25.0,
                     .torque_ff_nm = static_cast<float>(kHeldNm),
                     .stiffness_nm_per_rad = 20.0F};
  EXPECT_NEAR(torqueNm(first(asked)), kHeldNm, 1e-3);
  for (int i = 0; i < 500; ++i) EXPECT_NEAR(torqueNm(step(asked).target), kHeldNm, 1e-3);
}

}  // namespace
}  // namespace rc10::test::target_shaper_held_test
