// Loops that have wound up against a hand, or to brake a heavy wheel, on the simulated robot.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "daemon/one_motor_robot.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::windup_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMotor = 0;
constexpr Target kSlowly{.mode = ControlMode::kVelocity, .value = 20.0};

struct Case {
  const char* name;
  const char* motor;
};
void PrintTo(const Case& which, std::ostream* out) { *out << which.name; }
std::string nameOf(const ::testing::TestParamInfo<Case>& made) { return made.param.name; }

class WindupTest : public ::testing::TestWithParam<Case> {
 protected:
  void start(const std::string& keys, const std::string& model) {
    robot = std::make_unique<VirtualRobot>(oneMotorRobot("model: " + model + ", zero: power_on, " + keys));
    for (int i = 0; i < 4000 && seen().status != MotorStatus::kReady; ++i) robot->run(1);
    for (int i = 0; i < 4 && seen().status != MotorStatus::kActive; ++i) {
      robot->order(Operation::kEnable);
      robot->run(1000);
    }
    ASSERT_EQ(seen().status, MotorStatus::kActive);
  }
  const MotorSnapshot& seen() { return robot->motor(kMotor); }
  float rpm() { return seen().feedback.velocity_rpm; }
  double angleDeg() { return seen().feedback.total_angle_deg; }
  sim::Drive& drive() { return robot->simBus().drive(kMotor); }
  [[nodiscard]] bool held() { return drive().physics().held(); }
  /// On the way a hand stops the shaft, whatever its motor does: for two seconds, and one more.
  void windUp() {
    robot->hold(kMotor, kSlowly, 500);
    drive().physics().take({.speed_rpm = 50.0, .torque_nm = 500.0, .hold = 3s});
    robot->hold(kMotor, kSlowly, 2000);
    ASSERT_TRUE(held());
    ASSERT_NEAR(rpm(), 0.0F, 1.0F);
  }
  void holdUntilLetGo(const Target& target) {
    while (held()) robot->hold(kMotor, target, 1);
  }

  std::unique_ptr<VirtualRobot> robot;
};

/// At a soft limit, with little inertia and with much.
class WindupAtASoftLimit : public WindupTest {};

TEST_P(WindupAtASoftLimit, DoesNotDriveTheShaftPastIt) {
  for (const char* inertia : {"0.005", "0.02"}) {
    SCOPED_TRACE(inertia);
    const auto farthestDeg = [&](bool blocked) {
      start(std::string{"angle_min_deg: -20, angle_max_deg: 90, simulated: {inertia_kg_m2: "} + inertia + "}",
            GetParam().motor);
      if (blocked) {
        windUp();
        EXPECT_GT(angleDeg(), 30.0);
        EXPECT_LT(angleDeg(), 75.0);
        holdUntilLetGo(kSlowly);
      }
      double farthest_deg = angleDeg();
      for (int i = 0; i < 4000; ++i) {
        robot->hold(kMotor, kSlowly, 1);
        farthest_deg = std::max(farthest_deg, angleDeg());
      }
      EXPECT_EQ(seen().status, MotorStatus::kActive);
      return farthest_deg;
    };
    const double unblocked_deg = farthestDeg(false);
    EXPECT_GT(unblocked_deg, 89.0);
    EXPECT_LT(farthestDeg(true), unblocked_deg + 8.0);
  }
}

constexpr Case kM3508Case{"M3508", "M3508, id: 1"};
constexpr Case kM2006Case{"M2006", "M2006, id: 1"};
constexpr Case kYaw{"Gm6020", "GM6020, id: 5, command: current"};
constexpr Case kYawByVoltage{"Gm6020ByVoltage", "GM6020, id: 5, command: voltage"};
constexpr Case kMoteus{"Moteus", "moteus, id: 1, motor_kv_rpm_per_v: 100, current_limit_a: 20"};

INSTANTIATE_TEST_SUITE_P(Families, WindupAtASoftLimit,
                         ::testing::Values(kM3508Case, kM2006Case, kYaw, kYawByVoltage, kMoteus), nameOf);

/// Stops of a shaft that is blocked: with a finger, say.
class WindupInAStop : public WindupTest {
 protected:
  /// The most that the shaft moves once it is let go in the stop.
  double movesDeg() {
    while (held()) robot->run(1);
    const double before_deg = angleDeg();
    double most_deg = 0.0;
    for (int i = 0; i < 1500; ++i) {
      robot->run(1);
      most_deg = std::max(most_deg, std::fabs(angleDeg() - before_deg));
    }
    return most_deg;
  }
};

TEST_P(WindupInAStop, DoesNotPressOn) {
  for (const char* action : {"brake", "ramp", "hold"}) {
    SCOPED_TRACE(action);
    const std::string keys = std::string{"on_estop: "} + action + ", on_timeout: " + action;
    const std::string times =
        ", ramp_s: 3, brake_max_s: 30, hold_max_s: 30, simulated: {inertia_kg_m2: 0.01}";
    start(keys + times, GetParam().motor);
    windUp();
    robot->order(Operation::kEstop);
    EXPECT_LT(movesDeg(), 3.0) << "e-stop";
    start(keys + times, GetParam().motor);
    windUp();
    EXPECT_LT(movesDeg(), 3.0) << "its client is gone";
  }
  start("simulated: {inertia_kg_m2: 0.01}", GetParam().motor);
  windUp();
  holdUntilLetGo({.mode = ControlMode::kBrake});
  const double before_deg = angleDeg();
  robot->hold(kMotor, {.mode = ControlMode::kBrake}, 1500);
  EXPECT_NEAR(angleDeg(), before_deg, 3.0) << "a target";
}

INSTANTIATE_TEST_SUITE_P(Families, WindupInAStop,
                         ::testing::Values(kM3508Case, kM2006Case, kYaw, kYawByVoltage, kMoteus), nameOf);

/// Loops of rc10d alone: for a spring the place of a hold is that of its load, and stays.
class WindupInAHold : public WindupInAStop {};

TEST_P(WindupInAHold, DoesNotPressTowardsThePlaceOfAnEarlierHold) {
  start("on_timeout: hold, on_estop: hold, hold_max_s: 30, simulated: {inertia_kg_m2: 0.01}",
        GetParam().motor);
  robot->hold(kMotor, {.mode = ControlMode::kTotalAngle}, 500);
  robot->run(200);
  ASSERT_EQ(seen().acting, Acting::kHold);
  drive().physics().take({.by_deg = 20.0, .speed_rpm = 8.0, .torque_nm = 500.0, .hold = 3s});
  robot->run(2000);
  ASSERT_TRUE(held());
  robot->order(Operation::kEstop);
  EXPECT_LT(movesDeg(), 3.0);
}

INSTANTIATE_TEST_SUITE_P(Families, WindupInAHold,
                         ::testing::Values(kM3508Case, kM2006Case, kYaw, kYawByVoltage), nameOf);

/// A heavy wheel.
class WindupOfAWheel : public WindupTest {};

TEST_P(WindupOfAWheel, DoesNotTurnItBackAfterAStop) {
  for (const char* action : {"brake", "ramp"}) {
    SCOPED_TRACE(action);
    start(std::string{"on_estop: "} + action + ", ramp_s: 2, simulated: {inertia_kg_m2: 0.05}",
          GetParam().motor);
    robot->hold(kMotor, {.mode = ControlMode::kVelocity, .value = 300.0}, 3000);
    ASSERT_GT(rpm(), 200.0F);
    robot->order(Operation::kEstop);
    float slowest_rpm = rpm();
    for (int i = 0; i < 3000; ++i) {
      robot->run(1);
      slowest_rpm = std::min(slowest_rpm, rpm());
    }
    EXPECT_GT(slowest_rpm, -21.0F);
    EXPECT_LT(std::fabs(rpm()), 8.0F);
  }
}

TEST_P(WindupOfAWheel, IsNotDrivenForwardAfterAHandHasTurnedItBack) {
  start("on_estop: brake, brake_max_s: 60, simulated: {inertia_kg_m2: 0.05}", GetParam().motor);
  robot->hold(kMotor, {.mode = ControlMode::kVelocity, .value = 300.0}, 3000);
  robot->order(Operation::kEstop);
  robot->run(4000);
  drive().physics().take({.by_deg = -90.0, .speed_rpm = 30.0, .torque_nm = 500.0, .hold = 300ms});
  while (held()) robot->run(1);
  float fastest_rpm = 0.0F;
  for (int i = 0; i < 2000; ++i) {
    robot->run(1);
    fastest_rpm = std::max(fastest_rpm, rpm());
  }
  EXPECT_LT(fastest_rpm, 23.0F);
}

INSTANTIATE_TEST_SUITE_P(Families, WindupOfAWheel, ::testing::Values(kM3508Case, kYaw, kYawByVoltage),
                         nameOf);

/// A load that is moved: what carries it is no windup.
class CarriedLoad : public WindupTest {
 protected:
  static constexpr double kLoadNm = 0.4;

  void startLoaded(const std::string& keys) {
    start(keys + ", hold_max_s: 30, brake_max_s: 30", GetParam().motor);
    robot->hold(kMotor, {.mode = ControlMode::kTotalAngle}, 500);
    sim::MotorLoad load = drive().load();
    load.load_torque_nm = static_cast<float>(kLoadNm);
    drive().setLoad(load);
    robot->hold(kMotor, {.mode = ControlMode::kTotalAngle}, 1500);
  }
  /// Way down from here, in so many ticks.
  template <typename Tick>
  double sinksDeg(int ticks, const Tick& tick) {
    const double before_deg = angleDeg();
    double lowest_deg = before_deg;
    for (int i = 0; i < ticks; ++i) {
      tick();
      lowest_deg = std::min(lowest_deg, angleDeg());
    }
    return before_deg - lowest_deg;
  }
};

TEST_P(CarriedLoad, IsHeldByAStopOnTheWay) {
  for (const char* action : {"brake", "hold"}) {
    SCOPED_TRACE(action);
    startLoaded(std::string{"on_estop: "} + action);
    robot->hold(kMotor, kSlowly, 1500);
    ASSERT_NEAR(rpm(), 20.0F, 4.0F);
    robot->order(Operation::kEstop);
    EXPECT_LT(sinksDeg(2000, [this] { robot->run(1); }), 4.0);
  }
}

TEST_P(CarriedLoad, ThatIsFedForwardIsHeldByAStop) {
  for (const char* action : {"brake", "hold"}) {
    SCOPED_TRACE(action);
    startLoaded(std::string{"on_estop: "} + action);
    Target target = kSlowly;
    target.torque_ff_nm = static_cast<float>(kLoadNm);
    robot->hold(kMotor, target, 2500);
    ASSERT_NEAR(rpm(), 20.0F, 4.0F);
    robot->order(Operation::kEstop);
    EXPECT_LT(sinksDeg(2000, [this] { robot->run(1); }), 4.0);
  }
}

TEST_P(CarriedLoad, IsHeldByAStopOnTheWayDown) {
  startLoaded("on_estop: brake");
  robot->hold(kMotor, {.mode = ControlMode::kVelocity, .value = -40.0}, 1500);
  ASSERT_NEAR(rpm(), -40.0F, 6.0F);
  robot->order(Operation::kEstop);
  robot->run(1000);
  EXPECT_LT(sinksDeg(2000, [this] { robot->run(1); }), 1.0) << "once it has come to rest";
}

TEST_P(CarriedLoad, IsNotDroppedWhereSoftLimitsBoundItsSpeed) {
  const auto sinksAfter = [&](const std::string& keys) {
    startLoaded(keys);
    robot->hold(kMotor, {.mode = ControlMode::kVelocity, .value = 100.0}, 1500);
    EXPECT_NEAR(rpm(), 100.0F, 8.0F);
    return sinksDeg(2000, [this] { robot->hold(kMotor, {.mode = ControlMode::kVelocity}, 1); });
  };
  const double free_deg = sinksAfter("on_estop: brake");
  EXPECT_LT(sinksAfter("angle_min_deg: -5000, angle_max_deg: 5000"), free_deg + 3.0);
}

TEST_P(CarriedLoad, IsNotLetGoByATouch) {
  startLoaded("on_estop: brake");
  robot->order(Operation::kEstop);
  robot->run(500);
  drive().physics().take({.by_deg = 2.0, .speed_rpm = 5.0, .torque_nm = 500.0, .hold = 20ms});
  while (held()) robot->run(1);
  EXPECT_LT(sinksDeg(2000, [this] { robot->run(1); }), 8.0);
}

TEST_P(CarriedLoad, IsLiftedByAClientThatComesLate) {
  startLoaded("on_timeout: hold");
  const double before_deg = angleDeg();
  for (int i = 0; i < 60; ++i) {
    robot->command(kMotor, {.mode = ControlMode::kVelocity, .value = 30.0});
    robot->run(55);  // 50 of them valid
  }
  EXPECT_GT(angleDeg(), before_deg + 20.0);
}

TEST_P(CarriedLoad, IsHeldInTheFirstMomentOfALift) {
  startLoaded("on_estop: brake");
  robot->hold(kMotor, {.mode = ControlMode::kVelocity, .value = 60.0}, 15);
  robot->order(Operation::kEstop);
  EXPECT_LT(sinksDeg(2000, [this] { robot->run(1); }), 6.0);
}

INSTANTIATE_TEST_SUITE_P(Families, CarriedLoad, ::testing::Values(kM3508Case, kYaw, kYawByVoltage), nameOf);

/// RobStride in `control: position`, whose brake is a place.
class BrakeByPlace : public WindupTest {
 protected:
  static constexpr const char* kRs00 = "RS00, id: 3, control: position";
};

TEST_F(BrakeByPlace, DoesNotLeapAfterAZero) {
  start("on_estop: brake, brake_max_s: 30", kRs00);
  robot->hold(kMotor, {.mode = ControlMode::kTotalAngle, .value = 20.0}, 2000);
  robot->order(Operation::kEstop);
  robot->run(200);
  ASSERT_EQ(seen().acting, Acting::kBrake);
  const double before_deg = drive().physics().outputAngleDeg();
  EXPECT_EQ(robot->order(Operation::kZero, 120.0).motors[kMotor], Refusal::kNone);
  robot->run(1000);
  EXPECT_NEAR(drive().physics().outputAngleDeg(), before_deg, 0.5);
  EXPECT_NEAR(angleDeg(), 120.0, 0.5);
}

TEST_F(BrakeByPlace, GivesWayToAHandAndDoesNotComeBack) {
  start("on_timeout: brake, simulated: {inertia_kg_m2: 0.05}", kRs00);
  robot->hold(kMotor, {.mode = ControlMode::kTotalAngle}, 1000);
  robot->run(200);
  ASSERT_EQ(seen().acting, Acting::kBrake);
  drive().physics().take({.by_deg = 60.0, .speed_rpm = 8.0, .torque_nm = 500.0, .hold = 300ms});
  while (drive().physics().held()) robot->run(1);
  float fastest_rpm = 0.0F;
  for (int i = 0; i < 2000; ++i) {
    robot->run(1);
    fastest_rpm = std::max(fastest_rpm, std::fabs(rpm()));
  }
  EXPECT_GT(angleDeg(), 50.0);
  EXPECT_LT(fastest_rpm, 20.0F);
  EXPECT_NEAR(rpm(), 0.0F, 1.0F);
}

}  // namespace
}  // namespace rc10::test::windup_test
