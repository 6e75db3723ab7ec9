// The default loops on a small plant: delay 2.5 ms, quantised speed, friction, feedback that beats
// against the tick. Loads: a bare wheel to three times that; ten times must stay stable.
#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "support/simple_plant.hpp"

namespace rc10::test::dji_closed_loop_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Case {
  const char* name;
  const DjiModel* model;
  DjiCommand command;
  double fast_rpm;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

struct Response {
  double settled_ms = 0.0;  ///< Outside the band for the last time.
  double overshoot = 0.0;
  double residual = 0.0;  ///< Largest error in the last third.
};

using Reading = std::function<double(SimplePlant&)>;

Response observe(DjiBench& bench, double target, double band, Duration duration, const Reading& reading) {
  Response response;
  const double from = reading(bench.plant());
  const double sign = target >= from ? 1.0 : -1.0;
  const MonotonicTime start = bench.now();
  bench.run(duration, [&] {
    const double error = reading(bench.plant()) - target;
    const Duration elapsed = bench.now() - start;
    response.overshoot = std::max(response.overshoot, sign * error);
    if (std::abs(error) > band)
      response.settled_ms = std::chrono::duration<double, std::milli>(elapsed).count();
    if (elapsed > duration * 2 / 3) response.residual = std::max(response.residual, std::abs(error));
  });
  return response;
}

double rpmOf(SimplePlant& plant) { return plant.rpm(); }
double degreesOf(SimplePlant& plant) { return plant.degrees(); }

class DjiClosedLoop : public testing::TestWithParam<Case> {
 protected:
  [[nodiscard]] MotorSettings config() const {
    MotorSettings config = djiConfig(*GetParam().model, 1, GetParam().command);
    config.zero_at_power_on = true;
    return config;
  }
  [[nodiscard]] SimplePlant plant(double inertia_factor) const {
    SimplePlant plant = plantOf(*GetParam().model);
    plant.inertia_kg_m2 *= inertia_factor;
    return plant;
  }
  Response velocityStep(double target_rpm, double inertia_factor, int direction = 1) {
    MotorSettings wheel = config();
    wheel.direction = direction;
    DJI_Motor motor(wheel);
    DjiBench bench(motor, plant(inertia_factor));
    bench.run(milliseconds{20});
    motor.order(FrameKind::kCommand);
    EXPECT_TRUE(motor.setTargetRPM(Rpm{target_rpm}));
    const double sign = direction;  // the plant turns as the rotor does
    return observe(bench, target_rpm, std::max(2.0, 0.03 * std::abs(target_rpm)), seconds{2},
                   [sign](SimplePlant& p) { return sign * p.rpm(); });
  }
  Response angleStep(double target_deg, double inertia_factor) {
    DJI_Motor motor(config());
    DjiBench bench(motor, plant(inertia_factor));
    bench.run(milliseconds{20});
    motor.order(FrameKind::kCommand);
    EXPECT_TRUE(motor.setTargetTotalAngle(Degrees{target_deg}));
    return observe(bench, target_deg, std::max(1.0, 0.01 * std::abs(target_deg)), seconds{3}, degreesOf);
  }
};

TEST_P(DjiClosedLoop, SmallVelocityStepsSettleWithin150MsAndHardlyOvershoot) {
  for (const double target_rpm : {20.0, -20.0}) {
    const Response response = velocityStep(target_rpm, 1.0);
    EXPECT_LT(response.settled_ms, 150.0);
    EXPECT_LT(response.overshoot, 2.0);
    EXPECT_LT(response.residual, 1.0);
  }
}

TEST_P(DjiClosedLoop, LargeVelocityStepsSettleWithin200MsAndHardlyOvershoot) {
  for (const int direction : {1, -1}) {
    const Response response = velocityStep(GetParam().fast_rpm, 1.0, direction);
    EXPECT_LT(response.settled_ms, 200.0);
    EXPECT_LT(response.overshoot, 0.03 * GetParam().fast_rpm);
    EXPECT_LT(response.residual, 1.0);
  }
}

TEST_P(DjiClosedLoop, AHeavierWheelIsSlowerAndStillDamped) {
  const Response response = velocityStep(GetParam().fast_rpm, 3.0);
  EXPECT_LT(response.settled_ms, 350.0);
  EXPECT_LT(response.overshoot, 0.06 * GetParam().fast_rpm);
  EXPECT_LT(response.residual, 1.5);
}

TEST_P(DjiClosedLoop, HalfOrTenTimesTheInertiaIsStable) {
  EXPECT_LT(velocityStep(GetParam().fast_rpm, 0.5).residual, 1.0);
  const Response heavy = velocityStep(GetParam().fast_rpm, 10.0);
  EXPECT_LT(heavy.overshoot, 0.12 * GetParam().fast_rpm);
  EXPECT_LT(heavy.residual, 6.0);
  EXPECT_LT(angleStep(90.0, 10.0).residual, 10.0);
}

TEST_P(DjiClosedLoop, ALoadTorqueIsIntegratedAway) {
  DJI_Motor motor(config());
  DjiBench bench(motor, plant(1.0));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  bench.run(seconds{1});
  bench.plant().load_nm = 0.5;
  const Response response = observe(bench, 100.0, 3.0, seconds{1}, rpmOf);
  EXPECT_LT(response.settled_ms, 250.0);
  EXPECT_LT(response.residual, 1.0);
}

TEST_P(DjiClosedLoop, AngleStepsSettleWithoutOvershoot) {
  const Response small = angleStep(10.0, 1.0);
  EXPECT_LT(small.settled_ms, 200.0);
  EXPECT_LT(small.overshoot, 0.5);
  EXPECT_LT(small.residual, 0.3);
  const Response quarter = angleStep(-90.0, 1.0);
  EXPECT_LT(quarter.settled_ms, 500.0);
  EXPECT_LT(quarter.overshoot, 2.0);
  EXPECT_LT(quarter.residual, 0.3);
}

TEST_P(DjiClosedLoop, ManyTurnsEndWhereTheyShould) {
  const Response response = angleStep(1000.0, 1.0);
  EXPECT_LT(response.settled_ms, 1600.0);
  EXPECT_LT(response.overshoot, 5.0);
  EXPECT_LT(response.residual, 0.3);
  EXPECT_LT(angleStep(1000.0, 3.0).overshoot, 15.0);
}

TEST_P(DjiClosedLoop, TheAngleModeTakesTheShortWayFrom350To10) {
  DJI_Motor motor(config());
  DjiBench bench(motor, plant(1.0));
  bench.run(milliseconds{20});
  ASSERT_TRUE(motor.setZero(350.0));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetAngle(Degrees{10.0}));
  bench.run(seconds{1});
  EXPECT_NEAR(bench.plant().degrees(), 20.0, 0.5);
  ASSERT_TRUE(motor.setTargetAngle(Degrees{350.0}));
  bench.run(seconds{1});
  EXPECT_NEAR(bench.plant().degrees(), 0.0, 0.5);
}

TEST_P(DjiClosedLoop, BrakeStopsAndHoldKeepsAgainstALoad) {
  DJI_Motor motor(config());
  DjiBench bench(motor, plant(1.0));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{200.0}));
  bench.run(seconds{1});
  motor.order(FrameKind::kBrake);
  EXPECT_LT(observe(bench, 0.0, 5.0, milliseconds{500}, rpmOf).settled_ms, 200.0);
  motor.order(FrameKind::kHold);
  bench.run(milliseconds{100});
  const double held = bench.plant().degrees();
  bench.plant().load_nm = 0.5;
  EXPECT_LT(observe(bench, held, 15.0, seconds{1}, degreesOf).residual, 1.0);
}

TEST_P(DjiClosedLoop, StillnessIsStill) {
  DJI_Motor motor(config());
  DjiBench bench(motor, plant(1.0));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetTotalAngle(Degrees{30.0}));
  bench.run(seconds{2});
  double lowest = 1e9;
  double highest = -1e9;
  bench.run(seconds{1}, [&] {
    lowest = std::min(lowest, bench.plant().degrees());
    highest = std::max(highest, bench.plant().degrees());
  });
  EXPECT_LT(highest - lowest, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Models, DjiClosedLoop,
                         testing::Values(Case{"M3508", &kM3508, DjiCommand::kCurrent, 400.0},
                                         Case{"M2006", &kM2006, DjiCommand::kCurrent, 400.0},
                                         Case{"GM6020current", &kGM6020, DjiCommand::kCurrent, 250.0},
                                         Case{"GM6020voltage", &kGM6020, DjiCommand::kVoltage, 250.0}),
                         [](const auto& each) { return std::string{each.param.name}; });

}  // namespace
}  // namespace rc10::test::dji_closed_loop_test
