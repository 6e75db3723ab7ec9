// The mode input: reduced speed and current while a person is near, on a whole simulated robot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "daemon/exchange/events.hpp"
#include "daemon/one_motor_robot.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_reduced_mode_test {
namespace {

using enum ContactState;
using ::testing::HasSubstr;

constexpr std::size_t kWheel = 0;
constexpr Target kFast{.mode = ControlMode::kVelocity, .value = 400.0};

/// One M3508; what a tick may change of its speed tells a ramp from a jump.
class ReducedModeTest : public ::testing::Test {
 protected:
  void start(const std::string& keys, const std::string& model = "M3508, id: 1, zero: power_on") {
    robot = std::make_unique<VirtualRobot>(
        oneMotorRobot("model: " + model + ", " + keys, "mode_gpio: {chip: gpiochip0, line: 1}\n"));
    see(kClosed);
    for (int i = 0; i < 5; ++i) tick();
    enable();
  }
  /// At 150 rpm and with 500 ms for the way down, for which its current does not suffice.
  void startTooFastToBrake() {
    start(
        "reduced_velocity_rpm: 60, reduced_within_ms: 500, current_limit_a: 2, "
        "simulated: {inertia_kg_m2: 0.3}");
    for (int i = 0; i < 30'000 && rpm() < 150.0F; ++i) follow(kFast, 1);
    ASSERT_GE(rpm(), 150.0F);
  }
  /// Some drives are asked for their settings first.
  void enable() {
    for (int attempt = 0; attempt < 5 && status() != MotorStatus::kActive; ++attempt) {
      Order order;
      order.operation = Operation::kEnable;
      order.motors.set(kWheel);
      order.id = static_cast<std::uint64_t>(attempt) + 1;
      robot->exchange().orders.push(order);
      for (int i = 0; i < 1000 && status() != MotorStatus::kActive; ++i) tick();
      OrderResult answer;
      while (robot->exchange().results.pop(answer)) continue;
    }
    ASSERT_EQ(status(), MotorStatus::kActive);
  }
  void see(ContactState state) { contact = state; }
  void tick() {
    if (watched) robot->exchange().mode_contact.show(contact);
    robot->tick();
  }
  void follow(const Target& target, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      robot->command(kWheel, target);
      tick();
    }
  }
  /// The largest speed meanwhile.
  float fastestWhile(const Target& target, int ticks) {
    float fastest = 0.0F;
    for (int i = 0; i < ticks; ++i) {
      robot->command(kWheel, target);
      tick();
      fastest = std::max(fastest, std::fabs(rpm()));
    }
    return fastest;
  }
  float rpm() { return robot->motor(kWheel).feedback.velocity_rpm; }
  MotorStatus status() { return robot->motor(kWheel).status; }
  bool reduced() { return (robot->snapshot().conditions & kConditionReduced) != 0; }

  std::unique_ptr<VirtualRobot> robot;
  ContactState contact = kClosed;
  bool watched = true;
};

TEST_F(ReducedModeTest, WhileTheContactIsClosedNothingIsReduced) {
  start("reduced_velocity_rpm: 60");
  follow(kFast, 2000);
  EXPECT_NEAR(rpm(), 400.0F, 8.0F);
  EXPECT_FALSE(reduced());
}

TEST_F(ReducedModeTest, AFastShaftComesDownAlongARampWithinHalfOfTheTime) {
  start("reduced_velocity_rpm: 60, reduced_within_ms: 800");
  follow(kFast, 2000);
  see(kOpen);
  follow(kFast, 200);
  EXPECT_TRUE(reduced());
  EXPECT_NEAR(rpm(), 230.0F, 25.0F) << "half-way down in half of the ramp's time";
  EXPECT_NE(robot->motor(kWheel).limits & kLimitVelocity, 0U);
  EXPECT_NEAR(robot->motor(kWheel).target_shaped, 230.0, 5.0);
  EXPECT_EQ(robot->motor(kWheel).target.value, 400.0) << "as it was asked for";
  follow(kFast, 600);
  EXPECT_NEAR(rpm(), 60.0F, 4.0F);
  EXPECT_LT(fastestWhile(kFast, 3000), 66.0F);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

TEST_F(ReducedModeTest, TheSlewLimitIsTheRamp) {
  start("reduced_velocity_rpm: 60, velocity_slew_rpm_per_s: 1000, reduced_within_ms: 1000");
  follow(kFast, 3000);
  see(kOpen);
  follow(kFast, 170);
  EXPECT_NEAR(rpm(), 230.0F, 25.0F);
}

TEST_F(ReducedModeTest, WhoCannotBeReadOrIsNotWatchedIsReduced) {
  start("reduced_velocity_rpm: 60");
  see(kUnreadable);
  tick();
  EXPECT_TRUE(reduced());
  see(kClosed);
  for (int i = 0; i < 500; ++i) tick();
  EXPECT_FALSE(reduced());
  watched = false;
  follow(kFast, 250);
  EXPECT_TRUE(reduced()) << "nobody looks any more";
  follow(kFast, 1000);
  EXPECT_NEAR(rpm(), 60.0F, 4.0F);
}

TEST_F(ReducedModeTest, FullSpeedComesBackWithoutAJump) {
  start("reduced_velocity_rpm: 60");
  see(kOpen);
  follow(kFast, 2000);
  ASSERT_NEAR(rpm(), 60.0F, 4.0F);
  see(kClosed);
  float before = rpm();
  float largest_step = 0.0F;
  for (int i = 0; i < 50; ++i) {
    follow(kFast, 20);
    largest_step = std::max(largest_step, rpm() - before);
    before = rpm();
  }
  // From 60 to 480 rpm within a second: 8.4 rpm in 20 ms.
  EXPECT_LT(largest_step, 12.0F);
  follow(kFast, 500);
  EXPECT_NEAR(rpm(), 400.0F, 8.0F);
}

TEST_F(ReducedModeTest, ACrossingOfAnInstantCounts) {
  start("reduced_velocity_rpm: 60");
  robot->exchange().mode_contact.show(kOpen);
  robot->exchange().mode_contact.show(kClosed);
  robot->tick();
  EXPECT_TRUE(reduced());
}

// A loose wire.
TEST_F(ReducedModeTest, AContactThatFluttersIsOpen) {
  start("reduced_velocity_rpm: 60, reduced_current_a: 3");
  follow(kFast, 2000);
  for (int i = 0; i < 20; ++i) {
    see(i % 2 == 0 ? kOpen : kClosed);
    follow(kFast, 100);
  }
  EXPECT_TRUE(reduced());
  EXPECT_NEAR(rpm(), 60.0F, 4.0F);
  see(kClosed);
  follow(kFast, 399);
  EXPECT_TRUE(reduced()) << "closed for less than half a second";
  follow(kFast, 1);
  EXPECT_FALSE(reduced());
}

TEST_F(ReducedModeTest, AShaftThatStaysFastUnderAContactThatFluttersIsAFault) {
  startTooFastToBrake();
  for (int i = 0; i < 6; ++i) {
    see(i % 2 == 0 ? kOpen : kClosed);
    follow({.mode = ControlMode::kVelocity}, 100);
  }
  EXPECT_EQ(robot->motor(kWheel).fault, FaultCode::kReducedSpeed);
}

TEST_F(ReducedModeTest, ADriveThatKeepsItsLimitsIsToldTheReducedOnesWhileItIsEnabled) {
  robot = std::make_unique<VirtualRobot>(
      oneMotorRobot("model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, "
                    "velocity_limit_rpm: 600, command_divider: 10, reduced_current_a: 2, "
                    "simulated: {stalled: true}",
                    "mode_gpio: {chip: gpiochip0, line: 1}\n"));
  see(kOpen);
  for (int i = 0; i < 3000 && status() != MotorStatus::kReady; ++i) tick();
  Order order;
  order.operation = Operation::kEnable;
  order.motors.set(kWheel);
  order.id = 1;
  robot->exchange().orders.push(order);
  double most_a = 0.0;
  for (int i = 0; i < 2000; ++i) {
    follow({.mode = ControlMode::kVelocity, .value = 550.0}, 1);
    most_a = std::max(most_a, std::fabs(robot->simBus().drive(kWheel).physics().currentA()));
  }
  ASSERT_EQ(status(), MotorStatus::kActive);
  EXPECT_GT(most_a, 1.0);
  EXPECT_LT(most_a, 2.2);
}

TEST_F(ReducedModeTest, AShaftThatStaysFastIsAFaultAfterTheTime) {
  startTooFastToBrake();
  (void)robot->events();
  see(kOpen);
  follow({.mode = ControlMode::kVelocity}, 490);
  EXPECT_EQ(status(), MotorStatus::kActive) << "the time is not over";
  follow({.mode = ControlMode::kVelocity}, 20);
  EXPECT_EQ(status(), MotorStatus::kFault);
  EXPECT_EQ(robot->motor(kWheel).fault, FaultCode::kReducedSpeed);
  std::string told;
  for (const auto& event : robot->events()) told += describe(event) + '\n';
  EXPECT_THAT(told, HasSubstr("reduced speed and current: the mode input is open"));
  EXPECT_THAT(told, HasSubstr("too fast for reduced mode: faster than reduced_velocity_rpm allows"));
}

TEST_F(ReducedModeTest, AMotorThatIsEnabledMeanwhileHasTheTimeFromThenOn) {
  start("reduced_velocity_rpm: 60, reduced_within_ms: 500, simulated: {inertia_kg_m2: 0.02}");
  follow(kFast, 3000);
  Order order;
  order.operation = Operation::kDisable;
  order.motors.set(kWheel);
  order.id = 1;
  robot->exchange().orders.push(order);
  see(kOpen);
  for (int i = 0; i < 600; ++i) tick();
  ASSERT_EQ(status(), MotorStatus::kReady);
  ASSERT_GT(rpm(), 100.0F) << "it runs down without torque";
  enable();
  follow(kFast, 700);
  EXPECT_EQ(status(), MotorStatus::kActive);
  EXPECT_NEAR(rpm(), 60.0F, 4.0F);
}

TEST_F(ReducedModeTest, ACurrentTargetGainsNoMoreSpeedThanThat) {
  start("reduced_velocity_rpm: 60");
  const Target push{.mode = ControlMode::kCurrent, .value = 3.0};
  see(kOpen);
  EXPECT_LT(fastestWhile(push, 3000), 75.0F);
  EXPECT_EQ(status(), MotorStatus::kActive);
  see(kClosed);
  follow(push, 3000);
  EXPECT_GT(rpm(), 200.0F);
}

TEST_F(ReducedModeTest, AnAngleTargetIsApproachedSlowly) {
  start("reduced_velocity_rpm: 30, reduced_within_ms: 400");
  const Target far{.mode = ControlMode::kTotalAngle, .value = 3600.0};
  follow(far, 300);
  ASSERT_GT(rpm(), 150.0F) << "on its way at full speed";
  see(kOpen);
  follow(far, 400);
  EXPECT_LT(fastestWhile(far, 2000), 36.0F);
  EXPECT_GT(rpm(), 20.0F) << "it still goes there";
  EXPECT_EQ(status(), MotorStatus::kActive);
}

TEST_F(ReducedModeTest, AnAngleTargetThatBeginsMeanwhileNeverOvershootsTheSpeed) {
  start("reduced_velocity_rpm: 30");
  see(kOpen);
  tick();
  EXPECT_LT(fastestWhile({.mode = ControlMode::kTotalAngle, .value = 720.0}, 4500), 36.0F);
  EXPECT_NEAR(robot->motor(kWheel).feedback.total_angle_deg, 720.0, 2.0);
  EXPECT_LT(fastestWhile({.mode = ControlMode::kAngle, .value = 180.0}, 3000), 36.0F);
  EXPECT_NEAR(robot->motor(kWheel).feedback.angle_deg, 180.0F, 2.0F);
}

TEST_F(ReducedModeTest, ATrajectorysSpeedCountsIn) {
  start("reduced_velocity_rpm: 30");
  see(kOpen);
  tick();
  const Target led{.mode = ControlMode::kTotalAngle, .value = 7200.0, .velocity_ff_rpm = 200.0F};
  EXPECT_LT(fastestWhile(led, 3000), 36.0F);
}

TEST_F(ReducedModeTest, TheCurrentIsReducedOnceTheShaftIsSlow) {
  start("reduced_velocity_rpm: 60, reduced_current_a: 1, simulated: {inertia_kg_m2: 0.03}");
  follow(kFast, 3000);
  see(kOpen);
  float most_a = 0.0F;
  for (int i = 0; i < 1000; ++i) {
    follow(kFast, 1);
    if (std::fabs(rpm()) > 100.0F) most_a = std::max(most_a, std::fabs(robot->motor(kWheel).command_value));
  }
  EXPECT_GT(most_a, 1.5F) << "all there is to brake with";
  const Target back{.mode = ControlMode::kVelocity, .value = -60.0};
  for (int i = 0; i < 500; ++i) {
    follow(back, 1);
    ASSERT_LE(std::fabs(robot->motor(kWheel).command_value), 1.0F);
  }
}

TEST_F(ReducedModeTest, TheCurrentAloneIsReducedAtOnceAndComesBackWithinASecond) {
  start("reduced_current_a: 1, simulated: {stalled: true}");
  follow(kFast, 500);
  ASSERT_GT(robot->motor(kWheel).command_value, 10.0F);
  see(kOpen);
  follow(kFast, 1);
  EXPECT_LE(robot->motor(kWheel).command_value, 1.0F);
  see(kClosed);
  follow(kFast, 599);
  EXPECT_LE(robot->motor(kWheel).command_value, 3.1F);
  follow(kFast, 1000);
  EXPECT_GT(robot->motor(kWheel).command_value, 10.0F);
}

TEST_F(ReducedModeTest, AMotorWithoutReducedLimitsIsAsAlways) {
  start("reduced_current_a: 5");
  see(kOpen);
  follow(kFast, 2000);
  EXPECT_NEAR(rpm(), 400.0F, 8.0F);
}

TEST_F(ReducedModeTest, ATorqueFeedForwardDrivesNothingBeyondIt) {
  start("reduced_velocity_rpm: 20");
  see(kOpen);
  tick();
  EXPECT_LT(fastestWhile({.mode = ControlMode::kVelocity, .value = 20.0, .torque_ff_nm = 30.0F}, 2000),
            27.0F);
  EXPECT_LT(fastestWhile({.mode = ControlMode::kTotalAngle, .value = 7200.0, .torque_ff_nm = 30.0F}, 2000),
            27.0F);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

TEST_F(ReducedModeTest, AVescThatLetsGoBelowItsOwnMinimumIsNotToldMoreAndMore) {
  start("reduced_velocity_rpm: 20, zero: power_on",
        "VESC, id: 10, pole_pairs: 7, motor_current_max_a: 40, current_limit_a: 30, feedback_hz: 200");
  see(kOpen);
  tick();
  EXPECT_LT(fastestWhile({.mode = ControlMode::kTotalAngle, .value = 1000.0}, 2000), 25.0F);
  EXPECT_LE(robot->motor(kWheel).command_value, 20.0F);
}

/// Holds an angle against a load of 4 A, of the 7 A that the drive's own loop may take.
class OwnLoopReducedTest : public ReducedModeTest {
 protected:
  void hold(const std::string& model, const std::string& keys) {
    start(keys + "current_limit_a: 7, reduced_current_a: 3, stall_ms: 300, zero: power_on", model);
    auto& bus = robot->simBus();
    const auto& parameters = bus.motor(0).parameters();
    auto load = bus.drive(0).load();
    load.load_torque_nm = static_cast<float>(4.0 * parameters.torque_nm_per_a * parameters.gear_ratio);
    bus.setLoad(0, load);
    keep(1000);
  }
  void keep(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      if (hot) robot->simBus().setTemperature(0, 92.0);
      follow({.mode = ControlMode::kTotalAngle, .value = 0.0}, 1);
      ASSERT_EQ(status(), MotorStatus::kActive) << i << ": " << static_cast<int>(robot->motor(0).fault);
      ASSERT_EQ(robot->motor(0).limits & kLimitCurrent, 0U) << i;
    }
    EXPECT_NEAR(std::fabs(robot->motor(0).feedback.current_a), 4.0, 0.5);
  }
  bool hot = false;
};

TEST_F(OwnLoopReducedTest, ALoadThatTheDrivesOwnLoopHoldsIsNoStall) {
  for (const auto& [model, keys] : {std::pair{"RMD-X8-20, id: 22", ""},
                                    std::pair{"LK-MG5010E-i10, id: 12", "velocity_limit_rpm: 300, "}}) {
    SCOPED_TRACE(model);
    hot = false;
    contact = kClosed;
    hold(model, keys);
    see(kOpen);
    keep(2000);
    see(kClosed);
    hot = true;
    keep(2000);
  }
}

TEST_F(ReducedModeTest, ACurrentOfADriveOfUnknownSpeedIsBrakedByItsLoop) {
  start("reduced_velocity_rpm: 20, zero: power_on", "LK-MG5010E-i10, id: 12");
  const Target push{.mode = ControlMode::kCurrent, .value = 5.0};
  follow(push, 400);
  ASSERT_GT(rpm(), 200.0F);
  see(kOpen);
  follow(push, 1000);
  EXPECT_LT(fastestWhile(push, 1000), 27.0F);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

/// Drives with springs and angle loops of their own, which hurry to what they were told.
class ReducedAngleTest : public ReducedModeTest, public ::testing::WithParamInterface<const char*> {
 protected:
  /// The fastest that the shaft gets without torque from here on: what it has gained already.
  float speedGained() { return fastestWhile({}, 60); }
};

TEST_P(ReducedAngleTest, AWayThatHasJustBegunGainsNoSpeed) {
  for (const Target& way : {Target{.mode = ControlMode::kTotalAngle, .value = 3600.0},
                            Target{.mode = ControlMode::kAngle, .value = 170.0}}) {
    start("reduced_velocity_rpm: 20, zero: power_on", GetParam());
    follow(way, 4);
    const float gained_rpm = speedGained();
    start("reduced_velocity_rpm: 20, zero: power_on", GetParam());
    follow(way, 4);
    see(kOpen);
    EXPECT_LT(fastestWhile(way, 3000), std::max(1.1F * gained_rpm + 3.0F, 27.0F)) << way.value;
    EXPECT_GT(robot->motor(kWheel).feedback.total_angle_deg, 100.0) << "it still goes there";
    EXPECT_EQ(status(), MotorStatus::kActive);
  }
}

TEST_P(ReducedAngleTest, AHeldLoadIsNotDropped) {
  start("reduced_velocity_rpm: 20, zero: power_on, simulated: {gravity_nm: 1, hangs_at_deg: -90}",
        GetParam());
  const Target held{.mode = ControlMode::kTotalAngle};
  follow(held, 2000);
  const double before_deg = robot->motor(kWheel).feedback.total_angle_deg;
  see(kOpen);
  for (int i = 0; i < 1000; ++i) {
    follow(held, 1);
    ASSERT_NEAR(robot->motor(kWheel).feedback.total_angle_deg, before_deg, 2.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, ReducedAngleTest,
                         ::testing::Values("M3508, id: 1", "DM4310, id: 2, master_id: 18", "RS00, id: 3",
                                           "AK80-9, id: 5", "AK80-9, protocol: mit, id: 5",
                                           "RMD-X8-20, id: 11", "LK-MG5010E-i10, id: 12",
                                           "ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, "
                                           "current_limit_a: 40, velocity_limit_rpm: 600, feedback_hz: 200",
                                           "moteus, id: 1, motor_kv_rpm_per_v: 100, current_limit_a: 20, "
                                           "velocity_limit_rpm: 300"));

/// A hand pushes a shaft with some load away against all its torque, and lets it go.
class ReducedPushTest : public ReducedModeTest, public ::testing::WithParamInterface<const char*> {
 protected:
  static constexpr Target kPlace{.mode = ControlMode::kTotalAngle};

  /// The fastest that the shaft comes back; `stays` for some ticks, and tells the same of them.
  template <typename Stays>
  float fastestBack(const Stays& stays) {
    auto& shaft = robot->simBus().drive(kWheel).physics();
    shaft.take(
        {.by_deg = 60.0, .speed_rpm = 8.0, .torque_nm = 500.0, .hold = std::chrono::milliseconds{300}});
    while (shaft.held()) (void)stays(1);
    EXPECT_GT(robot->motor(kWheel).feedback.total_angle_deg, 50.0);
    return stays(4000);
  }
  void begin() {
    start(
        "reduced_velocity_rpm: 20, zero: power_on, on_timeout: hold, hold_max_s: 60, simulated: "
        "{inertia_kg_m2: 0.05}",
        GetParam());
    follow(kPlace, 500);
    see(kOpen);
  }
  void expectBack(float fastest_rpm) {
    EXPECT_LT(fastest_rpm, 30.0F);
    EXPECT_NEAR(robot->motor(kWheel).feedback.total_angle_deg, 0.0, 3.0);
    EXPECT_EQ(status(), MotorStatus::kActive);
  }
};

TEST_P(ReducedPushTest, AShaftComesBackSlowlyToItsTarget) {
  begin();
  follow(kPlace, 1500);
  expectBack(fastestBack([this](int ticks) { return fastestWhile(kPlace, ticks); }));
}

TEST_P(ReducedPushTest, AShaftComesBackSlowlyToWhereItIsHeld) {
  begin();
  const auto wait = [this](int ticks) {
    float fastest_rpm = 0.0F;
    for (int i = 0; i < ticks; ++i) {
      tick();
      fastest_rpm = std::max(fastest_rpm, std::fabs(rpm()));
    }
    return fastest_rpm;
  };
  (void)wait(1500);
  ASSERT_EQ(robot->motor(kWheel).acting, Acting::kHold);
  expectBack(fastestBack(wait));
  EXPECT_EQ(robot->motor(kWheel).acting, Acting::kHold);
}

// A moteus goes to the place it is told along a course of its own, the position loop of a VESC is its own:
// the table of docs/gpio.md.
INSTANTIATE_TEST_SUITE_P(Families, ReducedPushTest,
                         ::testing::Values("M3508, id: 1", "DM4310, id: 2, master_id: 18", "RS00, id: 3",
                                           "AK80-9, id: 5", "AK80-9, protocol: mit, id: 5",
                                           "RMD-X8-20, id: 11", "LK-MG5010E-i10, id: 12",
                                           "ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, "
                                           "current_limit_a: 40, velocity_limit_rpm: 600, feedback_hz: 200"));

// Its angle has leapt, and it has not moved.
TEST_F(ReducedModeTest, AHeldShaftThatIsZeroedIsNotLedToWhereItWasHeld) {
  start("reduced_velocity_rpm: 20, on_disable: hold, hold_max_s: 60", "DM4310, id: 2, master_id: 18");
  see(kOpen);
  follow({.mode = ControlMode::kTotalAngle}, 500);
  robot->order(Operation::kDisable);
  for (int i = 0; i < 100; ++i) tick();
  ASSERT_EQ(robot->motor(kWheel).acting, Acting::kHold);
  EXPECT_EQ(robot->order(Operation::kZero, 100.0).motors[kWheel], Refusal::kNone);
  float fastest_rpm = 0.0F;
  for (int i = 0; i < 1000; ++i) {
    tick();
    fastest_rpm = std::max(fastest_rpm, std::fabs(rpm()));
  }
  EXPECT_LT(fastest_rpm, 2.0F);
  EXPECT_NEAR(robot->motor(kWheel).feedback.total_angle_deg, 100.0, 1.0);
}

/// Soft limits, for targets that have no loop of the speed.
class SoftLimitOfADriveTest : public ReducedModeTest, public ::testing::WithParamInterface<const char*> {
 protected:
  void startAtMinus85() {
    start("reduced_velocity_rpm: 20, zero: power_on, angle_min_deg: -90, angle_max_deg: 90", GetParam());
    follow({.mode = ControlMode::kTotalAngle, .value = -85.0}, 1500);
    ASSERT_NEAR(angleDeg(), -85.0, 1.0);
  }
  double angleDeg() { return robot->motor(kWheel).feedback.total_angle_deg; }
  double farthestWhile(const Target& target, int ticks) {
    double farthest_deg = angleDeg();
    for (int i = 0; i < ticks; ++i) {
      follow(target, 1);
      farthest_deg = std::max(farthest_deg, angleDeg());
    }
    return farthest_deg;
  }
};

TEST_P(SoftLimitOfADriveTest, ACurrentStopsThereAndOneOfAFastShaftToo) {
  startAtMinus85();
  const Target push{.mode = ControlMode::kCurrent, .value = 3.0};
  const double farthest_deg = farthestWhile(push, 2000);
  EXPECT_GT(farthest_deg, 80.0) << "the current acts within the travel";
  EXPECT_LT(farthest_deg, 95.0);
  EXPECT_EQ(status(), MotorStatus::kActive);
  startAtMinus85();
  for (int i = 0; i < 1500 && angleDeg() < 0.0; ++i)
    follow({.mode = ControlMode::kVelocity, .value = 200.0}, 1);
  EXPECT_LT(farthestWhile(push, 1500), 95.0);
}

TEST_P(SoftLimitOfADriveTest, ACurrentStopsThereInReducedModeToo) {
  startAtMinus85();
  follow({.mode = ControlMode::kTotalAngle, .value = 85.0}, 1500);
  robot->exchange().mode_contact.show(kOpen);
  EXPECT_LT(farthestWhile({.mode = ControlMode::kCurrent, .value = 3.0}, 3000), 95.0);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

INSTANTIATE_TEST_SUITE_P(Families, SoftLimitOfADriveTest,
                         ::testing::Values("LK-MG5010E-i10, id: 12", "RMD-X8-20, id: 11",
                                           "AK80-9, protocol: mit, id: 5", "RS00, id: 3"));

class SoftLimitOfASpringTest : public SoftLimitOfADriveTest {};

TEST_P(SoftLimitOfASpringTest, ASpringWithoutDampingDoesNotSwingBeyond) {
  startAtMinus85();
  EXPECT_LT(
      farthestWhile({.mode = ControlMode::kImpedance, .value = 85.0, .stiffness_nm_per_rad = 10.0F}, 2500),
      100.0);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

INSTANTIATE_TEST_SUITE_P(Families, SoftLimitOfASpringTest,
                         ::testing::Values("DM4310, id: 2, master_id: 18", "AK80-9, protocol: mit, id: 5",
                                           "RS00, id: 3"));

/// Drives that close the loop themselves are told less.
class ReducedDriveTest : public ReducedModeTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(ReducedDriveTest, IsToldNoMoreThanTheReducedSpeed) {
  start("reduced_velocity_rpm: 20", GetParam());
  follow({.mode = ControlMode::kVelocity, .value = 60.0}, 2000);
  ASSERT_GT(rpm(), 50.0F);
  see(kOpen);
  follow({.mode = ControlMode::kVelocity, .value = 60.0}, 1000);
  EXPECT_EQ(status(), MotorStatus::kActive);
  EXPECT_LT(fastestWhile({.mode = ControlMode::kVelocity, .value = 60.0}, 1000), 25.0F);
}

INSTANTIATE_TEST_SUITE_P(Families, ReducedDriveTest,
                         ::testing::Values("GM6020, id: 6, command: voltage",
                                           "DM8009, id: 2, master_id: 18, control: velocity", "RS00, id: 3",
                                           "AK80-9, id: 5", "RMD-X8-20, id: 11", "LK-MG5010E-i10, id: 12"));

}  // namespace
}  // namespace rc10::test::supervisor_reduced_mode_test
