#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "app/s_curve_profile.hpp"
#include "app/slew_limiter.hpp"
#include "app/step_time.hpp"
#include "app/trapezoid_profile.hpp"

namespace rc10::test::profiles_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kDt = 0.001F;
constexpr auto kDtSeconds = static_cast<double>(kDt);

/// Limits of both kinds in one, to test the two alike.
struct Limits {
  double velocity;
  double acceleration;
  double jerk;
};

template <typename Profile>
Profile make(const Limits& limits);
template <>
TrapezoidProfile make(const Limits& limits) {
  return TrapezoidProfile({limits.velocity, limits.acceleration});
}
template <>
SCurveProfile make(const Limits& limits) {
  return SCurveProfile({limits.velocity, limits.acceleration, limits.jerk});
}
template <typename Profile>
constexpr bool kLimitsJerk = false;
template <>
constexpr bool kLimitsJerk<SCurveProfile> = true;

/// Holds a step against the limits, from the states at its ends: what is true in between for every
/// pair of instants is true of these.
template <typename Profile>
void expectWithin(const Limits& limits, const ProfileState& before, const ProfileState& after, double dt) {
  const double rounding = 1e-9 * (1.0 + std::abs(after.position));
  ASSERT_LE(std::abs(after.velocity), limits.velocity * (1.0 + 1e-9));
  ASSERT_LE(std::abs(after.acceleration), limits.acceleration * (1.0 + 1e-9));
  ASSERT_LE(std::abs(after.position - before.position), limits.velocity * dt + rounding);
  ASSERT_LE(std::abs(after.velocity - before.velocity), limits.acceleration * dt * (1.0 + 1e-9) + 1e-7);
  if (kLimitsJerk<Profile>) {
    ASSERT_LE(std::abs(after.acceleration - before.acceleration), limits.jerk * dt * (1.0 + 1e-9) + 1e-4);
  }
}

template <typename Profile>
class Profiles : public testing::Test {};
using Kinds = testing::Types<TrapezoidProfile, SCurveProfile>;
TYPED_TEST_SUITE(Profiles, Kinds);

TYPED_TEST(Profiles, HitTheTargetExactlyAndStayThere) {
  for (const double target : {90.0, -1e-6, 1e6 / 3.0, 1e-3, -720.1}) {
    auto profile = make<TypeParam>({500.0, 2000.0, 20'000.0});
    profile.reset(12.3);
    int steps = 0;
    while (!profile.restsAt(target) && steps < 1'000'000) {
      (void)profile.step(target, kDt);
      ++steps;
    }
    EXPECT_EQ(profile.state().position, target);
    (void)profile.step(target, kDt);
    EXPECT_TRUE(profile.restsAt(target));
  }
}

TYPED_TEST(Profiles, EndAMoveThatBeginsOrEndsFarOut) {
  struct Move {
    double from;
    double to;
  };
  for (const double far : {1e8, 3.3e9, -1e10, 1e11, 0.9e12}) {
    for (const Move move :
         {Move{far, far - 720.1}, Move{far + 0.3, far}, Move{far, far + 1e-3}, Move{far - 90.0, far}}) {
      for (const double velocity : {1.0, 50.0, 5000.0}) {
        auto profile = make<TypeParam>({velocity, 4.0 * velocity, 40.0 * velocity});
        profile.reset(move.from);
        const double way = std::abs(move.to - move.from);
        const auto enough = static_cast<int>((way / velocity + 2.0) / static_cast<double>(kDt));
        int steps = 0;
        while (!profile.restsAt(move.to) && steps < enough) {
          (void)profile.step(move.to, kDt);
          ++steps;
        }
        EXPECT_TRUE(profile.restsAt(move.to)) << move.from << " to " << move.to << " at " << velocity;
      }
    }
  }
}

TYPED_TEST(Profiles, ComeBackFromFarOut) {
  auto profile = make<TypeParam>({1e8, 1e8, 1e9});
  profile.reset(1.3e9);
  int steps = 0;
  while (!profile.restsAt(90.0) && steps < 60'000) {
    (void)profile.step(90.0, kDt);
    ++steps;
  }
  EXPECT_TRUE(profile.restsAt(90.0));
}

TYPED_TEST(Profiles, NeverExceedTheirLimitsUnderRandomRetargeting) {
  std::mt19937 random(2024);
  std::uniform_real_distribution<double> exponent(-1.0, 3.0);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int robot = 0; robot < 60; ++robot) {
    const Limits limits{std::pow(10.0, exponent(random)), std::pow(10.0, exponent(random) + 1.0),
                        std::pow(10.0, exponent(random) + 2.0)};
    auto profile = make<TypeParam>(limits);
    double target = 0.0;
    for (int i = 0; i < 4000; ++i) {
      if (random() % 100 == 0) target = unit(random) * std::pow(10.0, exponent(random));
      const float dt_s = 0.01F * std::abs(static_cast<float>(unit(random))) + 1e-5F;
      const ProfileState before = profile.state();
      const ProfileState after = profile.step(target, dt_s);
      ASSERT_NO_FATAL_FAILURE(expectWithin<TypeParam>(limits, before, after, static_cast<double>(dt_s)))
          << robot << ' ' << i;
    }
  }
}

TYPED_TEST(Profiles, NeverLeaveTheRangeOfTheirStartAndTheirTargets) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponent(-1.0, 3.0);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int robot = 0; robot < 60; ++robot) {
    auto profile = make<TypeParam>({std::pow(10.0, exponent(random)), std::pow(10.0, exponent(random) + 1.0),
                                    std::pow(10.0, exponent(random) + 2.0)});
    const unsigned every = robot % 2 == 0 ? 3 : 150;
    double target = 0.0;
    double low = 0.0;
    double high = 0.0;
    for (int i = 0; i < 4000; ++i) {
      if (random() % every == 0) target = 100.0 * unit(random);
      low = std::min(low, target);
      high = std::max(high, target);
      const ProfileState& state = profile.step(target, 0.01F * std::abs(static_cast<float>(unit(random))));
      ASSERT_GE(state.position, low - 1e-9) << robot << ' ' << i;
      ASSERT_LE(state.position, high + 1e-9) << robot << ' ' << i;
    }
  }
}

/// Whether stopping at once from this state passes the target on this side.
template <typename Profile>
bool stopsWithin(Profile profile, double side, double target) {
  for (int i = 0; i < 5000; ++i) {
    if (side * (profile.brake(0.0005F).position - target) > 0.0) return false;
  }
  return true;
}

TYPED_TEST(Profiles, DoNotOvershootATargetThereIsRoomToStopAt) {
  std::mt19937 random(99);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Limits limits{100.0, 400.0, 3000.0};
  int with_room = 0;
  for (int run = 0; run < 400; ++run) {
    auto profile = make<TypeParam>(limits);
    // Anywhere in mid-motion, half of the time while it turns back.
    const double first = 200.0 * unit(random);
    for (auto i = random() % 2000; i > 0; --i) (void)profile.step(first, kDt);
    for (auto i = random() % 300; i > 0 && run % 2 == 0; --i) (void)profile.step(-first, kDt);
    const double target = profile.state().position + 60.0 * unit(random);
    const double side = target - profile.stopPosition() >= 0.0 ? 1.0 : -1.0;
    const bool room = stopsWithin(profile, side, target);
    with_room += room ? 1 : 0;
    int steps = 0;
    while (!profile.restsAt(target) && steps++ < 20'000) {
      (void)profile.step(target, kDt * static_cast<float>(1.0 + 0.9 * unit(random)));
      if (room) {
        // More than stopsWithin() may have missed between its instants.
        ASSERT_LE(side * (profile.state().position - target), 1e-4) << run;
      }
    }
    ASSERT_TRUE(profile.restsAt(target)) << run;
  }
  EXPECT_GT(with_room, 100);
}

TYPED_TEST(Profiles, TakeAsLongWithEveryLengthOfStep) {
  const auto seconds = [](float dt_s) {
    auto profile = make<TypeParam>({50.0, 200.0, 2000.0});
    double t = 0.0;
    while (!profile.restsAt(100.0) && t < 100.0) {
      (void)profile.step(100.0, dt_s);
      t += static_cast<double>(dt_s);
    }
    return t;
  };
  const double fine = seconds(0.0002F);
  for (const float dt_s : {0.001F, 0.01F, 0.05F, 0.1F}) {
    EXPECT_NEAR(seconds(dt_s), fine, static_cast<double>(dt_s) + 0.0003) << dt_s;
  }
}

TYPED_TEST(Profiles, ATargetThatIsNotFiniteBrakesToRestWithinTheLimits) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    const Limits limits{100.0, 400.0, 3000.0};
    auto profile = make<TypeParam>(limits);
    for (int i = 0; i < 300; ++i) (void)profile.step(1000.0, kDt);
    const double stop = profile.stopPosition();
    for (int i = 0; i < 1000; ++i) {
      const ProfileState before = profile.state();
      const ProfileState after = profile.step(bad, kDt);
      ASSERT_NO_FATAL_FAILURE(expectWithin<TypeParam>(limits, before, after, kDtSeconds));
    }
    EXPECT_EQ(profile.state().velocity, 0.0);
    EXPECT_EQ(profile.state().acceleration, 0.0);
    EXPECT_NEAR(profile.state().position, stop, 1e-9);
  }
}

TYPED_TEST(Profiles, TimeThatDoesNotAdvanceChangesNothing) {
  auto profile = make<TypeParam>({100.0, 400.0, 3000.0});
  for (int i = 0; i < 100; ++i) (void)profile.step(1000.0, kDt);
  const ProfileState before = profile.state();
  for (const float dt_s : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(profile.step(-1000.0, dt_s), before);
    EXPECT_EQ(profile.brake(dt_s), before);
  }
}

TYPED_TEST(Profiles, AGapInTimeIsNoJump) {
  auto profile = make<TypeParam>({100.0, 400.0, 3000.0});
  for (int i = 0; i < 300; ++i) (void)profile.step(1000.0, kDt);
  auto longest = profile;
  EXPECT_EQ(profile.step(1000.0, 3600.0F), longest.step(1000.0, kMaxStepSeconds));
}

TYPED_TEST(Profiles, WithoutLimitsNothingMoves) {
  for (const double none : {0.0, -1.0, kNan, 1e-300}) {
    for (const Limits& limits : {Limits{none, 1.0, 1.0}, Limits{1.0, none, 1.0}, Limits{1.0, 1.0, none}}) {
      if (!kLimitsJerk<TypeParam> && limits.jerk != 1.0) continue;
      auto profile = make<TypeParam>(limits);
      profile.reset(5.0);
      for (int i = 0; i < 100; ++i) (void)profile.step(10.0, kDt);
      EXPECT_TRUE(profile.restsAt(5.0));
      EXPECT_EQ(profile.stopPosition(), 5.0);
    }
  }
  TypeParam untold;
  EXPECT_EQ(untold.step(10.0, kDt), ProfileState{});
}

TYPED_TEST(Profiles, LimitsThatAreTakenAwayInMotionStopIt) {
  auto profile = make<TypeParam>({100.0, 400.0, 3000.0});
  for (int i = 0; i < 300; ++i) (void)profile.step(1000.0, kDt);
  auto frozen = profile;
  if constexpr (kLimitsJerk<TypeParam>) {
    profile.setLimits({0.0, 400.0, 3000.0});
    frozen.setLimits({100.0, 400.0, 0.0});
  } else {
    profile.setLimits({0.0, 400.0});
    frozen.setLimits({100.0, 0.0});
  }
  const double stop = profile.stopPosition();
  for (int i = 0; i < 1000; ++i) (void)profile.step(1000.0, kDt);
  EXPECT_TRUE(profile.restsAt(profile.state().position));
  EXPECT_NEAR(profile.state().position, stop, 1e-9);
  EXPECT_EQ(frozen.step(1000.0, kDt).velocity, 0.0);
}

TYPED_TEST(Profiles, ALoweredLimitIsReturnedToAndTheTargetStillReached) {
  auto profile = make<TypeParam>({100.0, 400.0, 3000.0});
  for (int i = 0; i < 400; ++i) (void)profile.step(1000.0, kDt);
  if constexpr (kLimitsJerk<TypeParam>) {
    profile.setLimits({20.0, 100.0, 3000.0});
  } else {
    profile.setLimits({20.0, 100.0});
  }
  double velocity = profile.state().velocity;
  EXPECT_GT(velocity, 60.0);
  for (int i = 0; i < 2000; ++i) {
    (void)profile.step(1000.0, kDt);
    EXPECT_LE(profile.state().velocity, velocity + (kLimitsJerk<TypeParam> ? 0.4 : 1e-9));
    velocity = profile.state().velocity;
  }
  EXPECT_NEAR(velocity, 20.0, 1e-9);
  for (int i = 0; i < 100'000 && !profile.restsAt(1000.0); ++i) (void)profile.step(1000.0, kDt);
  EXPECT_TRUE(profile.restsAt(1000.0));
}

TYPED_TEST(Profiles, AnyInputGivesAFiniteState) {
  std::mt19937 random(7);
  const auto any = [&random] {
    return std::ldexp(static_cast<double>(random() % 2001) / 1000.0 - 1.0,
                      static_cast<int>(random() % 2048) - 1024);
  };
  for (int i = 0; i < 3000; ++i) {
    auto profile = make<TypeParam>({any(), any(), any()});
    profile.start({any(), any(), any()});
    for (int k = 0; k < 20; ++k) {
      (void)profile.step(any(), static_cast<float>(any()));
      ASSERT_TRUE(isFinite(profile.state())) << i << ' ' << k;
    }
  }
}

TYPED_TEST(Profiles, AStateThatIsNotFiniteIsRefused) {
  auto profile = make<TypeParam>({100.0, 400.0, 3000.0});
  profile.reset(3.0);
  profile.start({.position = 1.0, .velocity = kNan});
  profile.reset(kInfinity);
  EXPECT_TRUE(profile.restsAt(3.0));
}

/// Time from rest to rest.
template <typename Profile>
double secondsFor(const Limits& limits, double way) {
  auto profile = make<Profile>(limits);
  int steps = 0;
  while (!profile.restsAt(way) && steps < 1'000'000) {
    (void)profile.step(way, 0.0001F);
    ++steps;
  }
  return steps * static_cast<double>(0.0001F);
}

TEST(TrapezoidProfile, TakesTheShortestTime) {
  // Without and with cruising: 2 sqrt(s / a), and s / v + v / a.
  EXPECT_NEAR(secondsFor<TrapezoidProfile>({100.0, 50.0, 0.0}, 8.0), 0.8, 2e-4);
  EXPECT_NEAR(secondsFor<TrapezoidProfile>({10.0, 50.0, 0.0}, 8.0), 1.0, 2e-4);
}

TEST(SCurveProfile, TakesTheShortestTime) {
  // Biagiotti, Melchiorri, Trajectory Planning for Automatic Machines and Robots: rest to rest
  // with neither limit reached: 4 cbrt(s / 2j); only acceleration; both.
  EXPECT_NEAR(secondsFor<SCurveProfile>({100.0, 100.0, 32.0}, 1.0), 4.0 * std::cbrt(1.0 / 64.0), 2e-4);
  const double a = 2.0;
  const double j = 8.0;
  EXPECT_NEAR(secondsFor<SCurveProfile>({100.0, a, j}, 5.0),
              a / j + std::sqrt(a * a / (j * j) + 4.0 * 5.0 / a), 2e-4);
  EXPECT_NEAR(secondsFor<SCurveProfile>({1.0, a, j}, 5.0), 5.0 / 1.0 + 1.0 / a + a / j, 2e-4);
  EXPECT_NEAR(secondsFor<SCurveProfile>({0.3, a, j}, 5.0), 5.0 / 0.3 + 2.0 * std::sqrt(0.3 / j), 2e-4);
}

TEST(SCurveProfile, GoesOnFromAnyStateWithoutAJumpOfTheAcceleration) {
  SCurveProfile profile({100.0, 400.0, 3000.0});
  profile.start({.position = 5.0, .velocity = -30.0, .acceleration = 200.0});
  ProfileState before = profile.state();
  for (int i = 0; i < 3000 && !profile.restsAt(20.0); ++i) {
    const ProfileState after = profile.step(20.0, kDt);
    EXPECT_LE(std::abs(after.acceleration - before.acceleration), 3000.0 * kDtSeconds + 1e-4);
    before = after;
  }
  EXPECT_TRUE(profile.restsAt(20.0));
}

TEST(SlewLimiter, RisesByItsRateAndHitsTheTarget) {
  SlewLimiter limiter(10.0);
  EXPECT_NEAR(limiter.step(1.0, 0.01F), 0.1, 1e-7);
  for (int i = 0; i < 10; ++i) (void)limiter.step(1.0, 0.01F);
  EXPECT_EQ(limiter.value(), 1.0);
}

TEST(SlewLimiter, BrakesByItsOtherRateAndChangesItOnTheWayThroughZero) {
  SlewLimiter limiter({.away_per_s = 10.0, .towards_per_s = 40.0});
  limiter.reset(3.0);
  EXPECT_NEAR(limiter.step(-5.0, 0.05F), 1.0, 1e-6);
  // Half of the step to 0, the other half beyond.
  EXPECT_NEAR(limiter.step(-5.0, 0.05F), -0.25, 1e-6);
  EXPECT_NEAR(limiter.step(-5.0, 0.05F), -0.75, 1e-6);
  EXPECT_NEAR(limiter.step(-0.5, 0.05F), -0.5, 1e-6);
}

TEST(SlewLimiter, NeverChangesFasterThanItsRates) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  SlewLimiter limiter({.away_per_s = 3.0, .towards_per_s = 9.0});
  for (int i = 0; i < 100'000; ++i) {
    const double before = limiter.value();
    const double target = unit(random);
    const float dt_s = 0.1F * static_cast<float>(std::abs(unit(random)));
    const double after = limiter.step(target, dt_s);
    const double rate = std::abs(after) > std::abs(before) && after * before >= 0.0 ? 3.0 : 9.0;
    ASSERT_LE(std::abs(after - before), rate * static_cast<double>(dt_s) + 1e-12);
    ASSERT_GE(after, std::min(before, target));
    ASSERT_LE(after, std::max(before, target));
  }
}

TEST(SlewLimiter, InputThatMakesNoSenseKeepsTheValue) {
  SlewLimiter limiter(10.0);
  limiter.reset(2.0);
  limiter.reset(kNan);
  for (const double bad : {kNan, kInfinity, -kInfinity}) EXPECT_EQ(limiter.step(bad, kDt), 2.0);
  for (const float dt_s : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(limiter.step(5.0, dt_s), 2.0);
  }
  EXPECT_NEAR(limiter.step(1e300, 1e30F), 3.0, 1e-6);
}

TEST(SlewLimiter, ARateOfZeroAllowsNoChangeAndAnInfiniteOneAny) {
  for (const double none : {0.0, -3.0, kNan}) {
    SlewLimiter limiter(none);
    EXPECT_EQ(limiter.step(5.0, kDt), 0.0);
  }
  SlewLimiter free(kInfinity);
  EXPECT_EQ(free.step(5.0, kDt), 5.0);
  EXPECT_EQ(free.step(-7.0, kDt), -7.0);
}

TEST(TwistSlewLimiter, ChangesTheVelocityStraightTowardsItsTarget) {
  TwistSlewLimiter limiter({.linear_m_s2 = 5.0, .angular_deg_s2 = 100.0});
  const Twist2D& twist = limiter.step({.vx_m_s = 3.0, .vy_m_s = 4.0, .wz_deg_s = -90.0}, 0.1F);
  EXPECT_NEAR(twist.vx_m_s, 0.3, 1e-7);
  EXPECT_NEAR(twist.vy_m_s, 0.4, 1e-7);
  EXPECT_NEAR(twist.wz_deg_s, -10.0, 1e-5);
  const Twist2D target{.vx_m_s = 3.0, .vy_m_s = 4.0, .wz_deg_s = -90.0};
  for (int i = 0; i < 10; ++i) (void)limiter.step(target, 0.1F);
  EXPECT_EQ(limiter.value(), target);
}

TEST(TwistSlewLimiter, InputThatMakesNoSenseKeepsTheValue) {
  TwistSlewLimiter limiter({.linear_m_s2 = 5.0, .angular_deg_s2 = 100.0});
  limiter.reset({.vx_m_s = 1.0});
  limiter.reset({.vx_m_s = kNan});
  EXPECT_EQ(limiter.step({.vx_m_s = kNan}, kDt), Twist2D{.vx_m_s = 1.0});
  EXPECT_EQ(limiter.step({.wz_deg_s = 5.0}, 0.0F), Twist2D{.vx_m_s = 1.0});
  EXPECT_TRUE(isFinite(limiter.step({.vx_m_s = 1e308, .vy_m_s = 1e308, .wz_deg_s = -1e308}, kDt)));
  TwistSlewLimiter none;
  EXPECT_EQ(none.step({.vx_m_s = 1.0}, kDt), Twist2D{});
}

}  // namespace
}  // namespace rc10::test::profiles_test
