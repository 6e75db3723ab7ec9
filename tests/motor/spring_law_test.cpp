#include "motor/spring_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rc10::test::spring_law {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Draw {
  double within(double low, double high) { return std::uniform_real_distribution{low, high}(generator); }
  SpringLaw law() {
    return {.position_rad = within(-12.0, 12.0),
            .velocity_rad_s = within(-40.0, 40.0),
            .stiffness_nm_per_rad = within(0.0, 500.0),
            .damping_nms_per_rad = within(0.0, 5.0),
            .torque_nm = within(-20.0, 20.0)};
  }
  SpringState state() { return {within(-12.0, 12.0), within(-40.0, 40.0)}; }

  std::mt19937 generator{7};
};

TEST(SpringRange, HasGainsFromNothingToItsEndsAndEachWhereItIsUnknown) {
  constexpr SpringRange kDrive{.stiffness_nm_per_rad = 500.0, .damping_nms_per_rad = 5.0};
  EXPECT_TRUE(kDrive.has(0.0F, 0.0F));
  EXPECT_TRUE(kDrive.has(500.0F, 5.0F));
  EXPECT_FALSE(kDrive.has(500.1F, 5.0F));
  EXPECT_FALSE(kDrive.has(500.0F, 5.01F));
  EXPECT_FALSE(kDrive.has(-0.1F, 0.0F));
  EXPECT_FALSE(kDrive.has(static_cast<float>(kNaN), 0.0F));
  EXPECT_TRUE(SpringRange{}.has(1e9F, 1e9F));
}

TEST(SpringLaw, AddsUpSpringDamperAndTorque) {
  const SpringLaw law{.position_rad = 1.0,
                      .velocity_rad_s = 2.0,
                      .stiffness_nm_per_rad = 10.0,
                      .damping_nms_per_rad = 0.5,
                      .torque_nm = 0.25};
  EXPECT_DOUBLE_EQ(torqueNm(law, {0.5, -1.0}), 5.0 + 1.5 + 0.25);
}

TEST(SpringLaw, APartWithoutAGainIsNothingHoweverUnknownItsMeasurement) {
  EXPECT_DOUBLE_EQ(torqueNm({.torque_nm = 3.0}, {kNaN, kNaN}), 3.0);
  EXPECT_DOUBLE_EQ(torqueNm({.position_rad = kNaN, .damping_nms_per_rad = 2.0}, {0.0, 1.0}), -2.0);
}

TEST(SpringLaw, GainsStayBetweenNothingAndWhatAFrameCanSay) {
  const auto bounded = [](double stiffness, double damping) {
    SpringLaw law{.stiffness_nm_per_rad = stiffness, .damping_nms_per_rad = damping};
    boundGains(law, 500.0, 5.0);
    return law;
  };
  EXPECT_EQ(bounded(600.0, 6.0).stiffness_nm_per_rad, 500.0);
  EXPECT_EQ(bounded(600.0, 6.0).damping_nms_per_rad, 5.0);
  EXPECT_EQ(bounded(20.0, 0.5).stiffness_nm_per_rad, 20.0);
  EXPECT_EQ(bounded(-1.0, kNaN).stiffness_nm_per_rad, 0.0);
  EXPECT_EQ(bounded(-1.0, kNaN).damping_nms_per_rad, 0.0);
}

TEST(SpringLaw, ALeadIsAsLargeAsTheDampingLetsItRunAtTheLimit) {
  SpringLaw law{.position_rad = 9.0, .stiffness_nm_per_rad = 10.0, .damping_nms_per_rad = 2.0};
  EXPECT_TRUE(boundLead(law, {1.0, 0.0}, -5.0, 5.0));
  EXPECT_DOUBLE_EQ(law.position_rad, 2.0);
  // Spring and damper balance at the limit.
  EXPECT_DOUBLE_EQ(torqueNm(law, {1.0, 5.0}), 0.0);
  EXPECT_FALSE(boundLead(law, {1.0, 0.0}, -5.0, 5.0));
}

TEST(SpringLaw, ALeadLeavesRoomForTheVelocityThatComesWithIt) {
  SpringLaw law{
      .position_rad = -9.0, .velocity_rad_s = -3.0, .stiffness_nm_per_rad = 10.0, .damping_nms_per_rad = 2.0};
  EXPECT_TRUE(boundLead(law, {1.0, 0.0}, -5.0 - law.velocity_rad_s, 5.0 - law.velocity_rad_s));
  EXPECT_DOUBLE_EQ(torqueNm(law, {1.0, -5.0}), 0.0);
}

TEST(SpringLaw, WithoutDampingOrStiffnessThereIsNoLead) {
  SpringLaw stiff{.position_rad = 9.0, .stiffness_nm_per_rad = 10.0};
  SpringLaw damped{.position_rad = 9.0, .damping_nms_per_rad = 2.0};
  EXPECT_FALSE(boundLead(stiff, {}, -1.0, 1.0));
  EXPECT_FALSE(boundLead(damped, {}, -1.0, 1.0));
}

TEST(SpringLaw, NeitherSpringNorDamperGivesMoreThanTheBound) {
  Draw draw;
  for (int i = 0; i < 1000; ++i) {
    SpringLaw law = draw.law();
    const SpringState at = draw.state();
    const double most_nm = draw.within(0.0, 20.0);
    const SpringLaw before = law;
    const bool changed = boundParts(law, at, most_nm);
    EXPECT_EQ(changed,
              law.position_rad != before.position_rad || law.velocity_rad_s != before.velocity_rad_s);
    EXPECT_LE(std::fabs(law.stiffness_nm_per_rad * (law.position_rad - at.position_rad)), most_nm + 1e-9);
    EXPECT_LE(std::fabs(law.damping_nms_per_rad * (law.velocity_rad_s - at.velocity_rad_s)), most_nm + 1e-9);
    EXPECT_EQ(law.torque_nm, before.torque_nm);
  }
}

TEST(SpringLaw, WhateverYieldsTheSumIsTheBoundAndKeepsItsSign) {
  Draw draw;
  for (const auto yields : {SpringYield::kErrors, SpringYield::kGains, SpringYield::kTarget}) {
    for (int i = 0; i < 1000; ++i) {
      SpringLaw law = draw.law();
      const SpringState at = draw.state();
      const double most_nm = draw.within(0.0, 20.0);
      const double before_nm = torqueNm(law, at);
      const bool changed = boundTorque(law, at, most_nm, yields);
      EXPECT_EQ(changed, std::fabs(before_nm) > most_nm);
      EXPECT_NEAR(torqueNm(law, at), std::fmax(-most_nm, std::fmin(before_nm, most_nm)), 1e-9);
    }
  }
}

TEST(SpringLaw, ErrorsYieldBeforeTheGains) {
  SpringLaw law{.position_rad = 1.0,
                .velocity_rad_s = 4.0,
                .stiffness_nm_per_rad = 10.0,
                .damping_nms_per_rad = 2.0,
                .torque_nm = 2.0};
  ASSERT_TRUE(boundTorque(law, {}, 5.0, SpringYield::kErrors));
  EXPECT_DOUBLE_EQ(law.position_rad, 0.25);
  EXPECT_DOUBLE_EQ(law.velocity_rad_s, 1.0);
  EXPECT_DOUBLE_EQ(law.torque_nm, 0.5);
  EXPECT_EQ(law.stiffness_nm_per_rad, 10.0);
  EXPECT_EQ(law.damping_nms_per_rad, 2.0);
}

TEST(SpringLaw, GainsYieldAndTheTargetStays) {
  SpringLaw law{.position_rad = 1.0,
                .velocity_rad_s = 4.0,
                .stiffness_nm_per_rad = 10.0,
                .damping_nms_per_rad = 2.0,
                .torque_nm = 2.0};
  ASSERT_TRUE(boundTorque(law, {}, 5.0, SpringYield::kGains));
  EXPECT_EQ(law.position_rad, 1.0);
  EXPECT_EQ(law.velocity_rad_s, 4.0);
  EXPECT_DOUBLE_EQ(law.stiffness_nm_per_rad, 2.5);
  EXPECT_DOUBLE_EQ(law.damping_nms_per_rad, 0.5);
  EXPECT_DOUBLE_EQ(law.torque_nm, 0.5);
}

TEST(SpringLaw, TheTargetYieldsInPositionElseInVelocityElseInTorque) {
  SpringLaw sprung{.position_rad = 1.0, .stiffness_nm_per_rad = 10.0, .torque_nm = 2.0};
  ASSERT_TRUE(boundTorque(sprung, {}, 5.0, SpringYield::kTarget));
  EXPECT_DOUBLE_EQ(sprung.position_rad, 0.3);
  EXPECT_EQ(sprung.torque_nm, 2.0);
  SpringLaw damped{.velocity_rad_s = -8.0, .damping_nms_per_rad = 2.0};
  ASSERT_TRUE(boundTorque(damped, {}, 5.0, SpringYield::kTarget));
  EXPECT_DOUBLE_EQ(damped.velocity_rad_s, -2.5);
  SpringLaw torque{.torque_nm = 9.0};
  ASSERT_TRUE(boundTorque(torque, {}, 5.0, SpringYield::kTarget));
  EXPECT_DOUBLE_EQ(torque.torque_nm, 5.0);
}

// A drive keeps its last frame: with a speed it would turn the shaft for as long as it has power.
TEST(SpringLaw, OfALawThatResistsNothingButTheDampingYields) {
  const SpringState at{.position_rad = 3.0, .velocity_rad_s = 30.0};
  for (const auto yields : {SpringYield::kErrors, SpringYield::kGains, SpringYield::kTarget}) {
    SpringLaw law{.damping_nms_per_rad = 2.0, .resists = true};
    EXPECT_FALSE(boundParts(law, at, 18.0));
    ASSERT_TRUE(boundTorque(law, at, 18.0, yields));
    EXPECT_EQ(law.velocity_rad_s, 0.0);
    EXPECT_DOUBLE_EQ(law.damping_nms_per_rad, 0.6);
    ASSERT_TRUE(boundTorque(law, at, 0.0, yields));
    EXPECT_EQ(law.damping_nms_per_rad, 0.0);
  }
  // A velocity of 0 that somebody wants keeps its stiffness, as any other velocity.
  SpringLaw velocity{.damping_nms_per_rad = 2.0};
  ASSERT_TRUE(boundTorque(velocity, at, 18.0, SpringYield::kErrors));
  EXPECT_DOUBLE_EQ(velocity.damping_nms_per_rad, 2.0);
  EXPECT_TRUE(dampOnly({.stiffness_nm_per_rad = 1.0}, 2.0).resists);
}

TEST(SpringLaw, ResistanceKeepsOneStepOfItsFieldWhereThatIsNearerThanNone) {
  const auto kept = [](SpringLaw law) {
    keepResisting(law, 0.1);
    return law.damping_nms_per_rad;
  };
  EXPECT_EQ(kept({.damping_nms_per_rad = 0.06, .resists = true}), 0.1);
  EXPECT_EQ(kept({.damping_nms_per_rad = 0.04, .resists = true}), 0.04);
  EXPECT_EQ(kept({.damping_nms_per_rad = 0.16, .resists = true}), 0.16);
  EXPECT_EQ(kept({.damping_nms_per_rad = 0.06}), 0.06);
}

}  // namespace
}  // namespace rc10::test::spring_law
