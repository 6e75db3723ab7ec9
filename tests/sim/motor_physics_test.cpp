#include "sim/motor_physics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "drives/dji/dji_simulated_parameters.hpp"

namespace rc10::test::motor_physics_test {
namespace {

using namespace std::chrono_literals;
using sim::MotorLoad;
using sim::MotorParameters;
using sim::MotorPhysics;
using sim::parametersOf;
using sim::WindingCommand;

WindingCommand amperes(double value) { return {WindingCommand::Kind::kCurrent, value}; }
WindingCommand volts(double value) { return {WindingCommand::Kind::kVoltage, value}; }

MotorParameters parameters(const DjiModel& model, const MotorLoad& load = {}) {
  return parametersOf(model, model.gear_ratio, load);
}

double fullCurrent(const DjiModel& model) { return static_cast<double>(model.current.full_scale); }

class EveryModel : public testing::TestWithParam<const DjiModel*> {
 protected:
  const DjiModel& model_ = *GetParam();
};

INSTANTIATE_TEST_SUITE_P(Dji, EveryModel, testing::ValuesIn(djiModels()),
                         [](const auto& param) { return std::string{param.param->name}; });

TEST_P(EveryModel, ReachesItsNoLoadSpeedAt24VAndNoMore) {
  const auto no_load_rpm = static_cast<double>(model_.no_load_rpm);
  for (const double sign : {1.0, -1.0}) {
    MotorPhysics motor{parameters(model_), 0.0};
    double fastest_rpm = 0.0;
    for (int i = 0; i < 5000; ++i) {
      motor.step(amperes(sign * fullCurrent(model_)), 1ms);
      fastest_rpm = std::max(fastest_rpm, std::abs(motor.outputRpm()));
    }
    EXPECT_NEAR(motor.outputRpm(), sign * no_load_rpm, 0.005 * no_load_rpm);
    EXPECT_LE(fastest_rpm, 1.005 * no_load_rpm);
  }
}

TEST_P(EveryModel, StalledGivesCurrentTimesTorqueConstant) {
  MotorPhysics motor{parameters(model_), 10.0};
  motor.stall(true);
  motor.step(amperes(fullCurrent(model_)), 20ms);
  const double torque_nm_per_a = static_cast<double>(model_.rotor_torque_nm_per_a) * model_.gear_ratio;
  EXPECT_NEAR(motor.outputTorqueNm(), fullCurrent(model_) * torque_nm_per_a, 1e-6);
  EXPECT_EQ(motor.outputRpm(), 0.0);
  EXPECT_NEAR(motor.outputAngleDeg(), 10.0, 1e-9);
}

TEST_P(EveryModel, NeverCarriesMoreThanTheDrivesMaximum) {
  MotorPhysics motor{parameters(model_), 0.0};
  double most_a = 0.0;
  for (int i = 0; i < 1000; ++i) {
    motor.step(i % 20 < 10 ? amperes(1000.0) : volts(-1000.0), 1ms);
    ASSERT_LE(std::abs(motor.currentA()), fullCurrent(model_));
    most_a = std::max(most_a, std::abs(motor.currentA()));
  }
  EXPECT_GT(most_a, 0.99 * fullCurrent(model_));
}

TEST_P(EveryModel, StaysAtRestUntilTheTorqueExceedsCoulombFriction) {
  const MotorParameters p = parameters(model_);
  const double breakaway_a = p.output_coulomb_nm / (p.torque_nm_per_a * p.gear_ratio);
  MotorPhysics motor{p, 123.0};
  const double start_deg = motor.outputAngleDeg();
  for (int i = 0; i < 2000; ++i) {
    motor.step(amperes((i % 2 == 0 ? 0.98 : -0.98) * breakaway_a), 1ms);
    ASSERT_EQ(motor.outputRpm(), 0.0);
  }
  EXPECT_EQ(motor.outputAngleDeg(), start_deg);
  motor.step(amperes(1.05 * breakaway_a), 50ms);
  EXPECT_GT(motor.outputRpm(), 0.0);
}

TEST_P(EveryModel, CoastsToRestWithoutGainingEnergy) {
  MotorPhysics motor{parameters(model_), 0.0};
  motor.step(amperes(fullCurrent(model_)), 2s);
  motor.step(amperes(0.0), 10ms);  // the current decays
  double last_j = motor.kineticEnergyJ();
  ASSERT_GT(last_j, 0.0);
  int steps = 0;
  for (; steps < 100'000 && motor.outputRpm() != 0.0; ++steps) {
    motor.step(amperes(0.0), 1ms);
    ASSERT_LT(motor.kineticEnergyJ(), last_j);
    last_j = motor.kineticEnergyJ();
  }
  EXPECT_LT(steps, 100'000);
  const double rest_deg = motor.outputAngleDeg();
  motor.step(amperes(0.0), 1s);
  EXPECT_EQ(motor.outputAngleDeg(), rest_deg);
}

TEST_P(EveryModel, ShortedWindingBrakesHarderThanCoasting) {
  MotorPhysics coasting{parameters(model_), 0.0};
  coasting.step(amperes(fullCurrent(model_)), 2s);
  MotorPhysics shorted = coasting;
  coasting.step(amperes(0.0), 50ms);
  shorted.step(volts(0.0), 50ms);
  EXPECT_LT(shorted.outputRpm(), 0.8 * coasting.outputRpm());
  EXPECT_GE(shorted.outputRpm(), 0.0);
}

TEST_P(EveryModel, WindingReaches125DegreesAtTheRatedCurrentAndCoolsToTheRoom) {
  MotorParameters p = parameters(model_);
  p.heat_capacity_j_per_k /= 100.0;  // a minute is 0.6 s
  const double rated_a = std::sqrt((125.0 - p.ambient_c) / (p.thermal_resistance_k_per_w * p.resistance_ohm));
  MotorPhysics motor{p, 0.0};
  motor.stall(true);
  EXPECT_EQ(motor.temperatureC(), p.ambient_c);
  double last_c = motor.temperatureC();
  for (int minute = 0; minute < 60; ++minute) {
    motor.step(amperes(rated_a), 600ms);
    ASSERT_GT(motor.temperatureC(), last_c);
    last_c = motor.temperatureC();
  }
  EXPECT_NEAR(motor.temperatureC(), 125.0, 5.0);
  motor.step(amperes(0.0), 600ms);
  EXPECT_LT(motor.temperatureC(), last_c);
  motor.step(amperes(0.0), 72s);
  EXPECT_NEAR(motor.temperatureC(), p.ambient_c, 1.0);
}

TEST_P(EveryModel, AcceleratesNoFasterThanTheEncoderAssumes) {
  MotorPhysics motor{parameters(model_), 0.0};
  motor.step(amperes(-fullCurrent(model_)), 1s);
  double last_rpm = motor.rotorRpm();
  for (int i = 0; i < 200; ++i) {
    motor.step(amperes(fullCurrent(model_)), 1ms);
    ASSERT_LT((motor.rotorRpm() - last_rpm) / 0.001,
              static_cast<double>(model_.encoder.max_acceleration_rpm_per_s));
    last_rpm = motor.rotorRpm();
  }
  EXPECT_GT(last_rpm, 0.0) << "it accelerated at all";
}

TEST(MotorPhysics, CurrentFollowsItsCommandWithTheLoopsLag) {
  MotorParameters p = parameters(kM3508);
  p.current_lag_s = 0.005;
  MotorPhysics motor{p, 0.0};
  motor.stall(true);
  motor.step(amperes(10.0), 5ms);
  EXPECT_NEAR(motor.currentA(), 10.0 * (1.0 - std::exp(-1.0)), 0.2);
}

TEST(MotorPhysics, VoltageAtStallGivesVoltageOverResistance) {
  MotorPhysics motor{parameters(kGM6020), 0.0};
  motor.stall(true);
  motor.step(volts(12.0), 100ms);
  EXPECT_NEAR(motor.currentA(), 12.0 / motor.parameters().resistance_ohm, 1e-6);
}

TEST(MotorPhysics, GM6020TurnsAtItsRatedPointAsTheManualSays) {
  // GM6020 v1.2: 132 rpm at 1.2 N m and 24 V.
  MotorLoad load;
  load.load_torque_nm = 1.2F;
  load.coulomb_nm = 0.0F;
  load.viscous_nms_per_rad = 0.0F;
  MotorPhysics motor{parameters(kGM6020, load), 0.0};
  motor.step(volts(24.0), 5s);
  EXPECT_NEAR(motor.outputRpm(), 132.0, 20.0);
  EXPECT_NEAR(motor.currentA(), 1.62, 0.01);
}

TEST(MotorPhysics, AHangingWeightFallsUnlessFrictionOrTorqueHoldsIt) {
  MotorLoad load;
  load.coulomb_nm = 0.2F;
  load.load_torque_nm = 0.15F;
  MotorPhysics held{parameters(kM3508, load), 0.0};
  held.step(amperes(0.0), 1s);
  EXPECT_EQ(held.outputRpm(), 0.0);

  load.load_torque_nm = 0.6F;
  MotorPhysics falling{parameters(kM3508, load), 0.0};
  falling.step(amperes(0.0), 1s);
  EXPECT_LT(falling.outputRpm(), -10.0);

  MotorPhysics balanced{parameters(kM3508, load), 0.0};
  for (int i = 0; i < 1000; ++i) balanced.step(amperes(2.0), 1ms);  // 0.6 N m
  EXPECT_NEAR(balanced.outputAngleDeg(), 0.0, 1.0);
}

TEST(MotorPhysics, AnArmFallsToWhereItHangsAndNeedsItsGravityLevel) {
  MotorLoad load;
  load.inertia_kg_m2 = 0.05F;
  load.viscous_nms_per_rad = 0.05F;
  load.coulomb_nm = 0.0F;
  load.gravity_nm = 0.6F;
  load.hangs_at_deg = -90.0F;
  MotorPhysics let_go{parameters(kM3508, load), 60.0};
  let_go.step(amperes(0.0), 60s);
  EXPECT_NEAR(let_go.outputAngleDeg(), -90.0, 1.0);

  // Level is a quarter of a turn above: 2 A are the 0.6 N m that hold it there, and half of that at -60.
  MotorPhysics level{parameters(kM3508, load), 0.0};
  level.step(amperes(2.0), 300ms);
  EXPECT_NEAR(level.outputAngleDeg(), 0.0, 1.0);
  MotorPhysics halfway{parameters(kM3508, load), -60.0};
  halfway.step(amperes(1.0), 300ms);
  EXPECT_NEAR(halfway.outputAngleDeg(), -60.0, 1.0);
}

TEST(MotorPhysics, AStopHoldsTheShaftAndLetsItBack) {
  MotorLoad load;
  load.stop_min_deg = -20.0F;
  load.stop_max_deg = 45.0F;
  MotorPhysics motor{parameters(kM3508, load), 0.0};
  for (int i = 0; i < 2000; ++i) {
    motor.step(amperes(1.0), 1ms);
    ASSERT_LE(motor.outputAngleDeg(), 45.0 + 1e-9);
  }
  EXPECT_NEAR(motor.outputAngleDeg(), 45.0, 1e-9);
  EXPECT_EQ(motor.outputRpm(), 0.0);
  motor.step(amperes(-1.0), 100ms);
  EXPECT_LT(motor.outputAngleDeg(), 44.0);
  motor.step(amperes(-1.0), 2s);
  EXPECT_NEAR(motor.outputAngleDeg(), -20.0, 1e-9);
}

TEST(MotorPhysics, DrivenAboveItsNoLoadSpeedItBrakes) {
  MotorLoad load;
  load.load_torque_nm = -3.0F;  // drives in the positive direction
  MotorPhysics motor{parameters(kM3508, load), 0.0};
  motor.step(amperes(20.0), 5s);
  EXPECT_GT(motor.outputRpm(), 482.0);
  EXPECT_LT(motor.outputRpm(), 600.0);
  EXPECT_LT(motor.currentA(), 0.0);
}

TEST(MotorPhysics, AMotorWithoutItsGearIsFastAndWeak) {
  const MotorPhysics motor{parametersOf(kM3508, 1.0, {}), 0.0};
  MotorPhysics spun = motor;
  spun.step(amperes(20.0), 5s);
  EXPECT_NEAR(spun.outputRpm(), 482.0 * kM3508.gear_ratio, 100.0);
  EXPECT_LT(spun.parameters().output_coulomb_nm, 0.01);
}

TEST(MotorPhysics, ResultDoesNotDependOnHowTimeIsCut) {
  MotorPhysics whole{parameters(kM2006), 0.0};
  MotorPhysics quarters = whole;
  MotorPhysics fine = whole;
  for (int i = 0; i < 300; ++i) {
    const auto command = amperes(i < 150 ? 6.0 : -4.0);
    whole.step(command, 1ms);
    for (int j = 0; j < 4; ++j) quarters.step(command, 250us);
    for (int j = 0; j < 50; ++j) fine.step(command, 20us);
  }
  EXPECT_EQ(whole.rotorFraction(), quarters.rotorFraction());
  EXPECT_EQ(whole.outputRpm(), quarters.outputRpm());
  EXPECT_NEAR(whole.outputRpm(), fine.outputRpm(), 1.0);
  EXPECT_NEAR(whole.outputAngleDeg(), fine.outputAngleDeg(), 0.5);
}

TEST(MotorPhysics, PositionIsTheIntegralOfTheSpeed) {
  MotorPhysics motor{parameters(kM3508), 30.0};
  double expected_deg = motor.outputAngleDeg();
  for (int i = 0; i < 8000; ++i) {
    const double before_rpm = motor.outputRpm();
    motor.step(amperes(i < 6000 ? 15.0 : -15.0), MotorPhysics::kLongestStep);
    expected_deg += 0.5 * (before_rpm + motor.outputRpm()) * 6.0 * 0.00025;  // 1 rpm is 6 deg/s
  }
  EXPECT_GT(std::abs(motor.rotorTurns()), 50);
  EXPECT_NEAR(motor.outputAngleDeg(), expected_deg, 1e-6);
}

TEST(MotorPhysics, PositionIsAsFineAfterABillionTurnsAsAtTheStart) {
  MotorPhysics young{parametersOf(kM3508, 1.0, {}), 0.0};
  MotorPhysics old{parametersOf(kM3508, 1.0, {}), 360.0e9};
  ASSERT_EQ(old.rotorTurns(), 1'000'000'000);
  young.step(amperes(5.0), 10s);
  old.step(amperes(5.0), 10s);
  EXPECT_EQ(old.rotorTurns() - 1'000'000'000, young.rotorTurns());
  EXPECT_EQ(old.rotorFraction(), young.rotorFraction());
  EXPECT_GT(young.rotorTurns(), 1000);
}

TEST(MotorPhysics, StartsAtItsInitialAngleAlsoBelowZero) {
  const MotorPhysics motor{parameters(kGM6020), -90.0};
  EXPECT_EQ(motor.rotorTurns(), -1);
  EXPECT_DOUBLE_EQ(motor.rotorFraction(), 0.75);
  EXPECT_DOUBLE_EQ(motor.outputAngleDeg(), -90.0);
}

TEST(MotorPhysics, SurvivesAnyLoadTheConfigurationAllows) {
  for (const float inertia : {0.0F, 1e-6F, 100.0F}) {
    for (const float friction : {0.0F, 100.0F}) {
      for (const float torque : {0.0F, 1000.0F, -1000.0F}) {
        MotorLoad load{.inertia_kg_m2 = inertia,
                       .viscous_nms_per_rad = friction,
                       .coulomb_nm = friction,
                       .load_torque_nm = torque};
        MotorPhysics motor{parameters(kGM6020, load), 0.0};
        for (int i = 0; i < 200; ++i) motor.step(volts(i % 2 == 0 ? 24.0 : -24.0), 1ms);
        EXPECT_TRUE(std::isfinite(motor.outputAngleDeg()) && std::isfinite(motor.outputRpm()));
        EXPECT_TRUE(motor.rotorFraction() >= 0.0 && motor.rotorFraction() < 1.0);
      }
    }
  }
}

// A hand turns the shaft of a motor that has no current.
TEST_P(EveryModel, AHandTurnsItByAnAngleAndLetsGoAtRest) {
  for (const double by_deg : {90.0, -720.0}) {
    MotorPhysics motor{parameters(model_), 10.0};
    motor.take({.by_deg = by_deg, .speed_rpm = 60.0, .torque_nm = 5.0});
    EXPECT_TRUE(motor.held());
    int ticks = 0;
    for (; motor.held() && ticks < 10'000; ++ticks) motor.step(amperes(0), 1ms);
    // 360 deg/s, the time to get there, and to settle.
    EXPECT_NEAR(ticks, std::abs(by_deg) / 0.36 + 100 + 300, 2);
    EXPECT_NEAR(motor.outputAngleDeg(), 10.0 + by_deg, 0.5);
    EXPECT_NEAR(motor.outputRpm(), 0.0, 0.5);
  }
}

TEST_P(EveryModel, AHandNeverPullsHarderThanItsTorque) {
  MotorPhysics motor{parameters(model_, {.coulomb_nm = 2.0F}), 0.0};
  motor.take({.by_deg = 90.0, .speed_rpm = 60.0, .torque_nm = 1.9});
  for (int i = 0; i < 1000; ++i) motor.step(amperes(0), 1ms);
  EXPECT_EQ(motor.outputAngleDeg(), 0.0);
}

TEST_P(EveryModel, AFastHandDoesNotGoBeyondItsEnd) {
  MotorPhysics motor{parameters(model_), 0.0};
  motor.take({.by_deg = 360.0, .speed_rpm = 300.0, .torque_nm = 5.0});
  double furthest_deg = 0.0;
  while (motor.held()) {
    motor.step(amperes(0), 1ms);
    furthest_deg = std::max(furthest_deg, motor.outputAngleDeg());
  }
  EXPECT_LT(furthest_deg, 365.0);
  EXPECT_NEAR(motor.outputAngleDeg(), 360.0, 1.0);
}

// The motor runs from the hand and then lets go.
TEST_P(EveryModel, AHandDoesNotWhirlAShaftBackThatRanAway) {
  MotorPhysics motor{parameters(model_), 0.0};
  motor.take({.by_deg = 90.0, .speed_rpm = 30.0, .torque_nm = 0.2, .hold = 10s});
  for (int i = 0; i < 500; ++i) motor.step(amperes(fullCurrent(model_)), 1ms);
  ASSERT_GT(motor.outputAngleDeg(), 180.0);
  double fastest_back_rpm = 0.0;
  while (motor.held()) {
    motor.step(amperes(0), 1ms);
    fastest_back_rpm = std::max(fastest_back_rpm, -motor.outputRpm());
  }
  EXPECT_LE(fastest_back_rpm, 45.0);
}

// Above its no-load speed a motor brakes: the shaft comes late, and is led to its end all the same.
TEST_P(EveryModel, AHandLetsGoOfALateShaftWhenItIsAtRest) {
  MotorParameters slow = parameters(model_);
  slow.back_emf_vs_per_rad *= 10.0;
  MotorPhysics motor{slow, 0.0};
  motor.take({.by_deg = 360.0, .speed_rpm = 300.0, .torque_nm = 1.5});
  while (motor.held()) motor.step(amperes(0), 1ms);
  EXPECT_NEAR(motor.outputAngleDeg(), 360.0, 2.0);
  EXPECT_NEAR(motor.outputRpm(), 0.0, 1.0);
}

TEST(MotorPhysics, AHandGivesUpOnAShaftThatItsMotorKeepsTurning) {
  MotorPhysics motor{parameters(kM3508), 0.0};
  motor.take({.by_deg = 30.0, .speed_rpm = 60.0, .torque_nm = 0.2});
  int ticks = 0;
  for (; motor.held() && ticks < 20'000; ++ticks) motor.step(amperes(5.0), 1ms);
  EXPECT_LT(ticks, 7000);  // 1.2 s of its own, and kLedOnS
  EXPECT_GT(motor.outputRpm(), 100.0);
}

TEST(MotorPhysics, AHandHoldsAnArmAgainstGravityAndDropsItWhenItLetsGo) {
  MotorPhysics motor{parameters(kM3508, {.coulomb_nm = 0.0F, .gravity_nm = 2.0F}), 0.0};
  motor.take({.by_deg = 90.0, .speed_rpm = 60.0, .torque_nm = 5.0, .hold = 2s});
  for (int i = 0; i < 2000; ++i) motor.step(amperes(0), 1ms);
  EXPECT_NEAR(motor.outputAngleDeg(), 90.0, 1.0);
  EXPECT_TRUE(motor.held());
  for (int i = 0; i < 5000; ++i) motor.step(amperes(0), 1ms);
  EXPECT_FALSE(motor.held());
  EXPECT_LT(motor.outputAngleDeg(), 60.0);
}

TEST(MotorPhysics, APayloadAddsItsWeightAndItsInertia) {
  MotorLoad load{.inertia_kg_m2 = 0.01F, .coulomb_nm = 0.0F, .gravity_nm = 0.5F};
  const MotorParameters bare = parameters(kM3508, load);
  load.payload_kg = 2.0F;
  load.payload_at_m = 0.25F;
  const MotorParameters loaded = parameters(kM3508, load);
  EXPECT_NEAR(loaded.output_gravity_nm - bare.output_gravity_nm, 2.0 * 9.80665 * 0.25, 1e-6);
  EXPECT_NEAR(loaded.totalInertia() - bare.totalInertia(), 2.0 * 0.25 * 0.25, 1e-9);
}

TEST(MotorPhysics, AddedInertiaSlowsTheShaftAndInertiaThatLeavesDoesNot) {
  const MotorLoad light{.inertia_kg_m2 = 0.01F, .viscous_nms_per_rad = 0.0F, .coulomb_nm = 0.0F};
  MotorLoad heavy = light;
  heavy.inertia_kg_m2 = 0.05F;
  MotorPhysics motor{parameters(kM3508, light), 0.0};
  for (int i = 0; i < 50; ++i) motor.step(amperes(5.0), 1ms);
  const double before_rpm = motor.outputRpm();
  const double momentum = parameters(kM3508, light).totalInertia() * before_rpm;
  ASSERT_GT(before_rpm, 1.0);
  motor.setParameters(parameters(kM3508, heavy));
  EXPECT_NEAR(parameters(kM3508, heavy).totalInertia() * motor.outputRpm(), momentum, 1e-9);
  const double heavy_rpm = motor.outputRpm();
  motor.setParameters(parameters(kM3508, light));
  EXPECT_EQ(motor.outputRpm(), heavy_rpm);
}

}  // namespace
}  // namespace rc10::test::motor_physics_test
