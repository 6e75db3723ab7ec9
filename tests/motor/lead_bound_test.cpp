#include "motor/lead_bound.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

namespace rc10::test::lead_bound_test {
namespace {

using namespace std::chrono_literals;

constexpr double kMostNm = 18.0;
constexpr double kLimitRadS = 3.0;

/// A shaft on a spring of 30 N·m/rad and 1 N·m·s/rad, in ticks of a millisecond. What is measured is two
/// ticks old.
struct Shaft {
  double load_nm = 0.0;  ///< Against positive angles.
  double inertia_kg_m2 = 0.05;
  SpringState at{};
  SpringState before{};
  double fastest_rad_s = 0.0;
  LeadBound bound{};
  MonotonicTime now{1h};

  void run(Duration time, double place_rad) {
    fastest_rad_s = 0.0;
    for (const auto end = now + time; now < end; now += 1ms) {
      SpringLaw law{.position_rad = place_rad, .stiffness_nm_per_rad = 30.0, .damping_nms_per_rad = 1.0};
      (void)bound.apply(law, before, kLimitRadS, kMostNm, now);
      (void)boundTorque(law, before, kMostNm, SpringYield::kErrors);
      before = at;
      at.velocity_rad_s += (torqueNm(law, at) - load_nm) / inertia_kg_m2 * 1e-3;
      at.position_rad += at.velocity_rad_s * 1e-3;
      fastest_rad_s = std::max(fastest_rad_s, std::fabs(at.velocity_rad_s));
    }
  }
};

TEST(LeadBound, AShaftWithoutALoadGoesNoFasterThanTheLimit) {
  for (const double inertia_kg_m2 : {0.005, 0.02, 0.1}) {
    Shaft shaft{.inertia_kg_m2 = inertia_kg_m2};
    shaft.run(4s, 6.0);
    EXPECT_NEAR(shaft.at.position_rad, 6.0, 0.01) << inertia_kg_m2;
    EXPECT_LT(shaft.fastest_rad_s, 1.15 * kLimitRadS) << inertia_kg_m2;
    EXPECT_GT(shaft.fastest_rad_s, 0.8 * kLimitRadS) << inertia_kg_m2;
  }
}

TEST(LeadBound, ALoadSagsByLoadOverStiffnessAndSinksNoFarther) {
  for (const double load_nm : {5.0, -5.0, 15.0}) {
    Shaft shaft{.load_nm = load_nm};
    shaft.run(3s, 0.0);
    EXPECT_NEAR(shaft.at.position_rad, -load_nm / 30.0, 0.02) << load_nm;
    EXPECT_LT(shaft.fastest_rad_s, 2.5 * kLimitRadS) << load_nm;
  }
}

TEST(LeadBound, ALoadIsLiftedAndLoweredToItsPlace) {
  Shaft shaft{.load_nm = 10.0};
  shaft.run(1s, 0.0);
  shaft.run(6s, 4.0);
  EXPECT_NEAR(shaft.at.position_rad, 4.0 - 10.0 / 30.0, 0.02);
  EXPECT_LT(shaft.fastest_rad_s, 1.5 * kLimitRadS);
  shaft.run(6s, 0.0);
  EXPECT_NEAR(shaft.at.position_rad, -10.0 / 30.0, 0.02);
  EXPECT_LT(shaft.fastest_rad_s, 1.5 * kLimitRadS);
}

TEST(LeadBound, AShaftThatWasPushedAwayComesBackSlowly) {
  Shaft shaft;
  shaft.load_nm = 14.0;  // a hand
  shaft.run(1s, 0.0);
  shaft.load_nm = 0.0;
  shaft.at = shaft.before = {.position_rad = -1.5};
  shaft.run(60ms, 0.0);
  EXPECT_LT(shaft.fastest_rad_s, 2.5 * kLimitRadS);  // 18 rad/s without a bound
  shaft.run(3s, 0.0);
  EXPECT_LT(shaft.fastest_rad_s, 1.5 * kLimitRadS);
  EXPECT_NEAR(shaft.at.position_rad, 0.0, 0.01);
}

TEST(LeadBound, WithoutDampingNothingIsBounded) {
  LeadBound bound;
  SpringLaw law{.position_rad = 5.0, .stiffness_nm_per_rad = 30.0};
  EXPECT_FALSE(bound.apply(law, {}, kLimitRadS, kMostNm, MonotonicTime{1h}));
  EXPECT_EQ(law.position_rad, 5.0);
}

}  // namespace
}  // namespace rc10::test::lead_bound_test
