#include "motor/lead_bound.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace rc10::test::lead_bound_test {
namespace {

using namespace std::chrono_literals;

struct Drive {
  double stiffness_nm_per_rad = 30.0;
  double damping_nms_per_rad = 1.0;
  double most_nm = 18.0;
  double limit_rad_s = 3.0;
  int divider = 1;  ///< Ticks per frame.
};

constexpr double kRadSPerRpm = std::numbers::pi / 30.0;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kLimitRadS = Drive{}.limit_rad_s;
constexpr Drive kSlowDamiao{20.0, 1.0, 9.7, 10.0 * kRadSPerRpm};

/// A shaft on the spring of a drive, in ticks of a millisecond. What is measured is two ticks old.
struct Shaft {
  Drive drive{};
  double load_nm = 0.0;  ///< Against positive angles.
  double inertia_kg_m2 = 0.05;
  double friction_nm = 0.0;
  bool blocked = false;
  SpringState at{};
  SpringState before{};
  double fastest_rad_s = 0.0;
  double torque_nm = 0.0;
  SpringLaw law{};
  LeadBound bound{};
  int ticks = 0;
  MonotonicTime now{1h};

  void tick(double place_rad) {
    if (ticks++ % drive.divider == 0) {
      law = {.position_rad = place_rad,
             .stiffness_nm_per_rad = drive.stiffness_nm_per_rad,
             .damping_nms_per_rad = drive.damping_nms_per_rad};
      (void)bound.apply(law, before, drive.limit_rad_s, drive.most_nm, now);
      (void)boundTorque(law, before, drive.most_nm, SpringYield::kErrors);
    }
    now += 1ms;
    before = at;
    torque_nm = std::clamp(torqueNm(law, at), -drive.most_nm, drive.most_nm);
    if (blocked) return;
    const double driven_rad_s = at.velocity_rad_s + (torque_nm - load_nm) / inertia_kg_m2 * 1e-3;
    const double rubbed_rad_s = friction_nm / inertia_kg_m2 * 1e-3;
    at.velocity_rad_s = driven_rad_s - std::clamp(driven_rad_s, -rubbed_rad_s, rubbed_rad_s);
    at.position_rad += at.velocity_rad_s * 1e-3;
    fastest_rad_s = std::max(fastest_rad_s, std::fabs(at.velocity_rad_s));
  }
  void run(Duration time, double place_rad) {
    fastest_rad_s = 0.0;
    for (const auto end = now + time; now < end;) tick(place_rad);
  }
  /// A person blocks it at 0 on its way.
  void blockedFor(Duration time) {
    blocked = true;
    run(time, 60.0 * kRadPerDeg);
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

TEST(LeadBound, AtALowLimitALoadSwingsOnItsSpringAndSinksNoFarther) {
  struct Case {
    Drive drive;
    double inertia_kg_m2;
  };
  for (const auto& [drive, inertia_kg_m2] :
       {Case{{28.0, 0.98, 14.0, 2.0 * kRadSPerRpm}, 0.2}, Case{{28.0, 0.98, 14.0, 5.0 * kRadSPerRpm, 2}, 0.2},
        Case{{30.0, 1.0, 18.0, 10.0 * kRadSPerRpm, 2}, 0.26},
        Case{{20.0, 1.0, 9.7, 3.0 * kRadSPerRpm}, 0.28}}) {
    for (const double share : {0.7, -0.7}) {
      Shaft shaft{.drive = drive, .load_nm = share * drive.most_nm, .inertia_kg_m2 = inertia_kg_m2};
      const double balance_rad = -shaft.load_nm / drive.stiffness_nm_per_rad;
      shaft.run(6s, 0.0);
      EXPECT_NEAR(shaft.at.position_rad, balance_rad, 0.02) << inertia_kg_m2;
      shaft.run(10s, 0.0);
      EXPECT_NEAR(shaft.at.position_rad, balance_rad, 0.01) << inertia_kg_m2;
    }
  }
}

TEST(LeadBound, AShaftThatCarriesALoadKeepsUpWithAPlaceThatIsSlowerThanTheLimit) {
  for (const double inertia_kg_m2 : {0.0125, 0.05, 0.28}) {
    Shaft shaft{.drive = kSlowDamiao, .load_nm = 3.0, .inertia_kg_m2 = inertia_kg_m2, .friction_nm = 0.2};
    double place_rad = 0.0;
    for (int i = 1; i <= 3000; ++i) {
      place_rad = 48.0 * kRadPerDeg * 1e-3 * i;
      shaft.tick(place_rad);
      ASSERT_LT(place_rad - shaft.at.position_rad, 25.0 * kRadPerDeg) << i;
    }
    EXPECT_LT(place_rad - shaft.at.position_rad, 14.0 * kRadPerDeg) << inertia_kg_m2;
  }
}

TEST(LeadBound, APlaceBehindABlockedShaftIsNotPressedAwayFrom) {
  for (const double place_rad : {0.0, -60.0 * kRadPerDeg}) {
    Shaft shaft{.drive = kSlowDamiao};
    shaft.blockedFor(1500ms);
    ASSERT_GT(shaft.torque_nm, 9.0);
    for (int i = 0; i < 2000; ++i) {
      shaft.tick(place_rad);
      ASSERT_LT(shaft.torque_nm, 0.01) << i;
    }
  }
  // Less than all may be a load: it is given up little by little.
  Shaft shaft{.drive = kSlowDamiao};
  shaft.blockedFor(600ms);
  shaft.run(300ms, 0.0);
  EXPECT_LT(shaft.torque_nm, 0.01);
}

TEST(LeadBound, AtALowLimitTooItPressesOnForASecondAtMost) {
  for (const double limit_rpm : {1.0, 2.0}) {
    Drive drive = kSlowDamiao;
    drive.limit_rad_s = limit_rpm * kRadSPerRpm;
    Shaft shaft{.drive = drive};
    shaft.blockedFor(Duration{4s} / static_cast<int>(limit_rpm));  // short of all its torque
    shaft.run(1s, -60.0 * kRadPerDeg);
    EXPECT_LT(shaft.torque_nm, 0.01) << limit_rpm;
  }
}

TEST(LeadBound, ALoadThatWasLiftedAgainstAnObstacleIsLoweredSlowly) {
  for (const double limit_rpm : {5.0, 10.0}) {
    for (const double inertia_kg_m2 : {0.02, 0.05}) {
      Drive drive = kSlowDamiao;
      drive.limit_rad_s = limit_rpm * kRadSPerRpm;
      Shaft shaft{.drive = drive, .load_nm = 6.0, .inertia_kg_m2 = inertia_kg_m2};
      shaft.run(3s, 0.0);
      shaft.blockedFor(1500ms);
      shaft.blocked = false;
      shaft.run(500ms, -90.0 * kRadPerDeg);
      EXPECT_LT(shaft.fastest_rad_s, 1.5 * drive.limit_rad_s) << limit_rpm << " rpm, " << inertia_kg_m2;
    }
  }
}

TEST(LeadBound, AShoveDuringALiftDropsNothing) {
  Drive drive = kSlowDamiao;
  drive.limit_rad_s = 2.0 * kRadSPerRpm;
  Shaft shaft{.drive = drive, .load_nm = 6.0};
  shaft.run(3s, 0.0);
  shaft.run(1s, 1.0);
  const double place_rad = shaft.at.position_rad;
  for (int i = 0; i < 10; ++i) {
    shaft.at.velocity_rad_s = 1.7 * drive.limit_rad_s;
    shaft.tick(1.0);
  }
  for (int i = 0; i < 1000; ++i) {
    shaft.tick(1.0);
    ASSERT_GT(shaft.at.position_rad, place_rad - 0.02) << i;
  }
}

TEST(LeadBound, BeforeAStopWhatStandsAtItsLimitEndsAndALoadStays) {
  Shaft blocked{.drive = kSlowDamiao};
  blocked.blockedFor(1500ms);
  blocked.bound.dropWindup(0.0, kSlowDamiao.limit_rad_s, kSlowDamiao.most_nm);
  blocked.tick(60.0 * kRadPerDeg);
  EXPECT_NEAR(blocked.torque_nm, kSlowDamiao.limit_rad_s * kSlowDamiao.damping_nms_per_rad, 0.01);

  Shaft loaded{.drive = kSlowDamiao, .load_nm = 6.5};
  loaded.run(3s, 0.0);
  loaded.bound.dropWindup(0.0, kSlowDamiao.limit_rad_s, kSlowDamiao.most_nm);
  loaded.run(1s, 0.0);
  EXPECT_NEAR(loaded.at.position_rad, -6.5 / 20.0, 0.01);
  EXPECT_LT(loaded.fastest_rad_s, 0.02);
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
  EXPECT_FALSE(bound.apply(law, {}, kLimitRadS, Drive{}.most_nm, MonotonicTime{1h}));
  EXPECT_EQ(law.position_rad, 5.0);
}

}  // namespace
}  // namespace rc10::test::lead_bound_test
