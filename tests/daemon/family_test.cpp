// Every family on a whole robot with its simulated drive: enabled, moved, lost, restarted, faulted, cleared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "config/load_config.hpp"
#include "config/motor_families.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/frame_calls.hpp"

namespace rc10::test::family_test {
namespace {

using ::testing::AnyOf;

struct Subject {
  const char* name;
  const char* motor;           ///< Its keys after the name.
  std::uint32_t native_fault;  ///< A code of this family; 0: it reports none.
  bool told_of_restart;        ///< It notices that the drive has forgotten everything.
  const char* bus = "";
  double rpm = 30.0;
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

const Subject kSubjects[] = {
    {"Vesc", "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500", 4, true, "",
     300.0},  // a stock one lets go below 900 ERPM
    {"DamiaoMit", "model: DM4310, id: 1, master_id: 17", 0xA, true},
    {"DamiaoVelocity", "model: DM8009, id: 2, master_id: 18, control: velocity", 0xB, true},
    {"RobStride", "model: RS00, id: 3", 1, true},
    {"CyberGear", "model: CyberGear, id: 4", 1, true},
    {"CubeMarsServo", "model: AK80-9, id: 5", 1, true},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit", 1, false},
    {"Moteus", "model: moteus, id: 7, motor_kv_rpm_per_v: 100", 33, true, "data_bitrate: 5000000\n    "},
    {"OdriveS1",
     "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600",
     0x200, true},
    {"OdriveV3",
     "model: ODrive_v3, id: 9, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600",
     0x40, true},
    {"MyActuator", "model: RMD-X8-20, id: 11", 0x0004, true},
    {"LkTech", "model: LK-MG5010E-i10, id: 12", 1, true},
};

std::string textOf(const Subject& subject) {
  return std::string{"robot: family\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    "} +
         subject.bus + "motors:\n      - {name: motor, " + subject.motor + "}\n";
}

RobotConfig configOf(const Subject& subject) {
  auto outcome = parseRobotConfig(textOf(subject), "family.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

// An e-stop ends in what holds the motor best of what its drive can.
RobotConfig heldInEstops(const Subject& subject) {
  auto config = configOf(subject);
  auto& motor = config.buses[0].motors[0];
  const auto& frames = motor.traits().frames;
  motor.fallback.on_estop = frames.hold != Provision::kUnsupported    ? FallbackAction::kHold
                            : frames.brake != Provision::kUnsupported ? FallbackAction::kBrake
                                                                      : FallbackAction::kDamp;
  return config;
}

// As an operator would: some drives refuse while they start.
bool activate(VirtualRobot& robot) {
  const auto is = [&robot](MotorStatus status) { return robot.motor(0).status == status; };
  for (int i = 0; i < 4000 && !is(MotorStatus::kReady); ++i) robot.run(1);
  for (int i = 0; i < 4 && !is(MotorStatus::kActive); ++i) {
    robot.order(Operation::kEnable);
    robot.run(1000);
  }
  return is(MotorStatus::kActive);
}

class Family : public ::testing::TestWithParam<Subject> {
 protected:
  static constexpr std::size_t kMotor = 0;

  explicit Family(const RobotConfig& config = configOf(GetParam())) : robot(config) {}

  MotorStatus status() { return robot.motor(kMotor).status; }
  double rpm() { return static_cast<double>(robot.motor(kMotor).feedback.velocity_rpm); }
  /// The true motion of the shaft.
  double truth() { return drive().physics().outputRpm(); }
  sim::Drive& drive() { return robot.simBus().drive(kMotor); }
  bool waitFor(MotorStatus wanted, int ticks = 4000) {
    for (int i = 0; i < ticks && status() != wanted; ++i) robot.run(1);
    return status() == wanted;
  }
  /// Until it is, as an operator would: some drives refuse while they start.
  bool enable() {
    for (int attempt = 0; attempt < 4; ++attempt) {
      robot.order(Operation::kEnable);
      if (status() == MotorStatus::kActive) return true;
      robot.run(1000);
    }
    return false;
  }
  void turn(int ticks) {
    robot.hold(kMotor, {.mode = ControlMode::kVelocity, .value = GetParam().rpm}, ticks);
  }

  VirtualRobot robot;
};

TEST_P(Family, IsOnlineBeforeAnyoneEnablesItAndWithoutTorque) {
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  robot.run(3000);
  EXPECT_EQ(status(), MotorStatus::kReady);
  EXPECT_NEAR(drive().physics().currentA(), 0.0, 0.05);
}

TEST_P(Family, FollowsASpeedAndIsAtRestAfterItsLease) {
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  ASSERT_TRUE(enable());
  robot.run(50);
  EXPECT_NEAR(truth(), 0.0, 1.0) << "being enabled moves nothing";
  turn(3000);
  EXPECT_NEAR(truth(), GetParam().rpm, 0.1 * GetParam().rpm);
  EXPECT_NEAR(rpm(), truth(), 0.1 * GetParam().rpm);
  robot.run(4000);  // the client is gone
  EXPECT_EQ(status(), MotorStatus::kActive);
  EXPECT_LT(std::abs(truth()), 0.5 * GetParam().rpm) << "it runs down";
  // Some control modes know no enabled state without torque: they stand still (docs/motors/damiao.md).
  if (std::abs(truth()) > 1.0) {
    EXPECT_NEAR(drive().physics().currentA(), 0.0, 0.1);
  }
}

TEST_P(Family, EndsWithoutTorqueWhenItIsDisabledOrStopped) {
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  for (const auto operation : {Operation::kDisable, Operation::kEstop}) {
    ASSERT_TRUE(enable());
    turn(500);
    robot.order(operation);
    robot.run(100);
    EXPECT_EQ(status(), MotorStatus::kReady);
    EXPECT_NEAR(drive().physics().currentA(), 0.0, 0.1);
    robot.run(5000);
    robot.order(Operation::kClear);
  }
}

TEST_P(Family, ThatFallsSilentIsOfflineAndComesBackAtRest) {
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  ASSERT_TRUE(enable());
  turn(500);
  robot.simBus().silence(kMotor, true);
  turn(1500);
  EXPECT_EQ(status(), MotorStatus::kOffline);
  robot.simBus().silence(kMotor, false);
  robot.run(3000);
  EXPECT_THAT(status(), AnyOf(MotorStatus::kReady, MotorStatus::kFault));
  robot.order(Operation::kClear);
  robot.run(3000);
  EXPECT_EQ(status(), MotorStatus::kReady);
  EXPECT_NEAR(drive().physics().currentA(), 0.0, 0.05);
  EXPECT_TRUE(enable()) << "and it can be enabled again";
}

// Drives that only answer were not asked in a pause, and run on in it.
TEST_P(Family, AHoldAfterAPauseBeginsWhereTheShaftIs) {
  auto config = configOf(GetParam());
  auto& motor = config.buses[0].motors[0];
  const bool holds = motor.traits().frames.hold != Provision::kUnsupported;
  motor.fallback.on_timeout = holds ? FallbackAction::kHold : FallbackAction::kBrake;
  VirtualRobot paused{config};
  const auto angleDeg = [&] { return paused.simBus().drive(kMotor).physics().outputAngleDeg(); };
  ASSERT_TRUE(activate(paused));
  paused.hold(kMotor, {.mode = ControlMode::kVelocity, .value = GetParam().rpm}, 2000);
  const double before_deg = angleDeg();
  paused.tick(60);
  const auto fallback = holds ? Acting::kHold : Acting::kBrake;
  EXPECT_EQ(paused.motor(kMotor).acting, fallback) << "though it may have to measure first";
  const double after_deg = angleDeg();
  ASSERT_GT(after_deg, before_deg + 5.0) << "it ran on";
  paused.run(20);
  if (holds) {
    // Some milliseconds of way, and the step of an encoder.
    const double held_deg = paused.robot().motors()[kMotor].motor->heldAngleDeg();
    EXPECT_NEAR(held_deg, after_deg, 5.0 + 0.02 * GetParam().rpm) << "nothing pulls it back";
  }
  EXPECT_EQ(paused.motor(kMotor).acting, fallback);
}

// Its last speed is of before the pause.
TEST_P(Family, ARampAfterAPauseDoesNotDriveAShaftThatAnObstacleHasStopped) {
  auto config = configOf(GetParam());
  config.buses[0].motors[0].fallback.on_estop = FallbackAction::kRamp;
  config.buses[0].motors[0].fallback.ramp = std::chrono::seconds{2};
  VirtualRobot paused{config};
  ASSERT_TRUE(activate(paused));
  const Target turning{.mode = ControlMode::kVelocity, .value = GetParam().rpm};
  paused.hold(kMotor, turning, 2000);
  auto& shaft = paused.simBus().drive(kMotor).physics();
  paused.simBus().stall(kMotor, true);
  paused.exchange().estop.store(true);
  paused.tick(60);
  const double pushed_a = std::fabs(shaft.currentA());
  paused.run(8);  // until its current has gone
  double most_a = 0.0;
  double most_rpm = 0.0;
  for (int i = 0; i < 60; ++i) {
    paused.tick();
    const auto& seen = paused.motor(kMotor);
    // A loop of the drive keeps its integral, and is told a speed.
    const bool speed = seen.command_unit == CommandUnit::kNative;
    if (speed) most_rpm = std::max(most_rpm, std::fabs(static_cast<double>(seen.command_value)));
    if (!speed) most_a = std::max(most_a, std::fabs(shaft.currentA()));
  }
  EXPECT_LT(most_a, std::max(0.2, 0.25 * pushed_a));
  EXPECT_LT(most_rpm, 0.05 * GetParam().rpm);
  EXPECT_EQ(paused.motor(kMotor).acting, Acting::kRamp);
}

TEST_P(Family, ARampAfterAPauseBeginsAtTheSpeedOfTheShaft) {
  auto config = configOf(GetParam());
  config.buses[0].motors[0].fallback.on_estop = FallbackAction::kRamp;
  config.buses[0].motors[0].fallback.ramp = std::chrono::seconds{2};
  VirtualRobot paused{config};
  ASSERT_TRUE(activate(paused));
  paused.hold(kMotor, {.mode = ControlMode::kVelocity, .value = GetParam().rpm}, 2000);
  paused.exchange().estop.store(true);
  paused.tick(60);
  EXPECT_EQ(paused.motor(kMotor).acting, Acting::kRamp) << "though it may have to measure first";
  paused.run(1000);
  const double rpm = paused.simBus().drive(kMotor).physics().outputRpm();
  EXPECT_NEAR(rpm, 0.5 * GetParam().rpm, 0.2 * GetParam().rpm);
}

class RestartedFamily : public Family {};

TEST_P(RestartedFamily, ARestartOfTheDriveEndsActive) {
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  ASSERT_TRUE(enable());
  turn(500);
  drive().restart();
  turn(2500);
  EXPECT_NE(status(), MotorStatus::kActive);
  robot.run(3000);
  robot.order(Operation::kClear);
  robot.run(3000);
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  EXPECT_TRUE(enable());
  turn(2000);
  EXPECT_NEAR(truth(), GetParam().rpm, 0.1 * GetParam().rpm);
}

TEST_P(Family, AFaultOfTheDriveIsTheMotorsUntilItIsCleared) {
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  ASSERT_TRUE(enable());
  turn(500);
  drive().fault(GetParam().native_fault);
  ASSERT_TRUE(waitFor(MotorStatus::kFault, 1500));
  EXPECT_GE(static_cast<int>(robot.motor(kMotor).fault), 32) << "said by the drive";
  robot.run(5000);
  EXPECT_EQ(status(), MotorStatus::kFault) << "latched";
  drive().fault(0);  // its cause is over, the drive may still remember
  robot.order(Operation::kClear);
  robot.run(3000);
  EXPECT_EQ(status(), MotorStatus::kReady);
  EXPECT_EQ(robot.motor(kMotor).fault, FaultCode::kNone);
  EXPECT_TRUE(enable());
}

TEST_P(Family, AnEstopWhoseFirstFrameTheKernelRefusesIsToldInTheNextTick) {
  auto config = configOf(GetParam());
  config.buses[0].motors[0].settings.command_divider = 10;
  VirtualRobot seldom{config};
  ASSERT_TRUE(activate(seldom));
  const Target turning{.mode = ControlMode::kVelocity, .value = GetParam().rpm};
  seldom.hold(kMotor, turning, 500);
  const auto sent = [&] { return seldom.snapshot().buses[0].counters.tx_frames; };
  // Its next turn is nine ticks later.
  for (auto before = sent(); sent() == before;) seldom.hold(kMotor, turning, 1);
  const auto before = sent();
  seldom.exchange().estop.store(true);
  frameCalls() = {.refuse = [](const msghdr&) { return ENOBUFS; }};
  seldom.tick();
  frameCalls() = {};
  ASSERT_EQ(sent(), before);
  seldom.tick();
  EXPECT_GT(sent(), before);
}

TEST_P(Family, ADriveWithAnotherIdIsNotThere) {
  auto config = configOf(GetParam());
  auto& settings = config.buses[0].motors[0].settings;
  settings.id += 1;
  if (settings.own.number("master_id") != 0.0)
    settings.own.set("master_id", settings.own.number("master_id") + 1.0);
  VirtualRobot other{config};
  std::vector<CanFrame> mine;
  std::vector<CanFrame> others;
  robot.record(mine);
  other.record(others);
  ASSERT_TRUE(waitFor(MotorStatus::kReady));
  ASSERT_TRUE(enable());
  for (int i = 0; i < 4000 && other.motor(kMotor).status != MotorStatus::kReady; ++i) other.run(1);
  for (int i = 0; i < 4 && other.motor(kMotor).status != MotorStatus::kActive; ++i) {
    other.order(Operation::kEnable);
    other.run(1000);
  }
  robot.run(1000);
  // Spoken to by its own id it says all that it can, and none of it reaches the one.
  ASSERT_EQ(other.motor(kMotor).status, MotorStatus::kActive);
  ASSERT_GT(others.size(), 100U);
  auto& motor = *robot.robot().motors()[kMotor].motor;
  const auto matches = [&](const CanFrame& frame) { return motor.matchesFrame(frame); };
  EXPECT_EQ(std::count_if(others.begin(), others.end(), matches), 0);
  EXPECT_GT(std::count_if(mine.begin(), mine.end(), matches), 20);
}

class HeldFamily : public Family {
 protected:
  static constexpr MotorSet kOne{1U << kMotor};

  HeldFamily() : Family(heldInEstops(GetParam())) {}

  /// It turned, was stopped, and is held; the stop is cleared.
  [[nodiscard]] bool isHeld() {
    if (!waitFor(MotorStatus::kReady) || !enable()) return false;
    turn(500);
    robot.order(Operation::kEstop);
    robot.run(300);
    return isCleared() && robot.motor(kMotor).acting != Acting::kNothing;
  }
  /// Once it stands: some holds have a limit cycle.
  [[nodiscard]] bool isCleared() {
    for (int i = 0; i < 20'000 && robot.snapshot().state != RobotStatus::kRun; ++i)
      robot.order(Operation::kClear);
    return robot.snapshot().state == RobotStatus::kRun;
  }
};

TEST_P(HeldFamily, IsNotLetGoWhileItIsEnabledAnew) {
  ASSERT_TRUE(isHeld());
  const auto held = robot.motor(kMotor).acting;
  for (int stopped_after = 1; stopped_after <= 25; ++stopped_after) {
    SCOPED_TRACE(stopped_after);
    robot.beginEnabling(kOne);
    for (int i = 0; i < stopped_after; ++i) {
      robot.tick();
      ASSERT_EQ(robot.motor(kMotor).acting, held);
    }
    robot.order(Operation::kEstop);
    robot.run(150);
    ASSERT_EQ(robot.motor(kMotor).acting, held);
    ASSERT_EQ(robot.motor(kMotor).fault, FaultCode::kNone);
    ASSERT_EQ(status(), MotorStatus::kReady);
    ASSERT_TRUE(isCleared());
  }
}

TEST_P(HeldFamily, ADisableThatOvertakesItsEnablingLetsGo) {
  for (int later = 0; later <= 3; ++later) {
    SCOPED_TRACE(later);
    ASSERT_TRUE(isHeld());
    robot.beginEnabling(kOne);
    robot.run(later);
    robot.order(Operation::kDisable);
    robot.run(50);
    EXPECT_EQ(status(), MotorStatus::kReady);
    EXPECT_EQ(robot.motor(kMotor).acting, Acting::kNothing);
    robot.order(Operation::kDisable);
    robot.run(3000);
  }
}

class RestartedHeldFamily : public HeldFamily {};

TEST_P(RestartedHeldFamily, ADriveThatRestartsInTheTickOfItsEnablingDoesNotStayActive) {
  ASSERT_TRUE(isHeld());
  drive().restart();
  robot.beginEnabling(kOne);
  robot.run(500);
  EXPECT_NE(status(), MotorStatus::kActive);
}

TEST_P(HeldFamily, IsNotActiveBeforeItIsHeardAgainAfterAPauseInItsEnabling) {
  ASSERT_TRUE(isHeld());
  robot.beginEnabling(kOne);
  robot.tick();
  ASSERT_EQ(status(), MotorStatus::kEnabling);
  robot.simBus().silence(kMotor, true);
  robot.tick(500);
  EXPECT_NE(status(), MotorStatus::kActive);
}

TEST_P(HeldFamily, IsNotActiveByAnAnswerThatCameWithTheRequest) {
  robot.stampLate(std::chrono::microseconds{500});  // at the time of the tick
  ASSERT_TRUE(isHeld());
  robot.beginEnabling(kOne);
  robot.tick();
  robot.simBus().silence(kMotor, true);
  robot.run(3);
  EXPECT_EQ(status(), MotorStatus::kEnabling);
}

TEST_P(HeldFamily, ObeysAfterItWasEnabledWhileItWasHeld) {
  ASSERT_TRUE(isHeld());
  const auto held = robot.motor(kMotor).acting;
  ASSERT_TRUE(enable());
  robot.run(500);
  EXPECT_EQ(robot.motor(kMotor).acting, held) << "until the first target";
  turn(3000);
  EXPECT_EQ(status(), MotorStatus::kActive);
  EXPECT_NEAR(truth(), GetParam().rpm, 0.1 * GetParam().rpm);
}

RobotConfig heldWithBoundOrRamp(const Subject& subject, bool ramp, int divider) {
  auto config = heldInEstops(subject);
  auto& motor = config.buses[0].motors[0];
  motor.settings.command_divider = divider;
  motor.fallback.hold_max = std::chrono::milliseconds{400};
  motor.fallback.brake_max = std::chrono::milliseconds{400};
  motor.fallback.ramp = std::chrono::milliseconds{200};  // without torque 0.2 s later
  if (ramp) motor.fallback.on_estop = FallbackAction::kRamp;
  return config;
}

// The fallback ends, or becomes another, in each tick around that of enabling.
class EndingFamily : public ::testing::TestWithParam<std::tuple<Subject, bool, int>> {};

TEST_P(EndingFamily, IsEnabledInWhicheverTickItsFallbackEnds) {
  const auto& [subject, ramp, divider] = GetParam();
  int enabled = 0;
  for (const int ticks : {396, 399, 400, 401, 404}) {
    SCOPED_TRACE(ticks);
    VirtualRobot robot{heldWithBoundOrRamp(subject, ramp, divider)};
    ASSERT_TRUE(activate(robot));
    robot.hold(0, {.mode = ControlMode::kVelocity, .value = 0.0}, 1000);  // a stop is cleared at rest
    robot.order(Operation::kEstop);
    robot.run(ticks - 2);
    robot.order(Operation::kClear);
    if (robot.snapshot().state != RobotStatus::kRun) continue;  // it still turns
    ++enabled;
    const auto result = robot.order(Operation::kEnable);
    EXPECT_EQ(result.motors[0], Refusal::kNone);
    EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
    robot.run(200);
    EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
    if (ramp) {
      EXPECT_EQ(robot.motor(0).acting, Acting::kNothing);
    }
    robot.hold(0, {.mode = ControlMode::kVelocity, .value = subject.rpm}, 3000);
    EXPECT_NEAR(robot.simBus().drive(0).physics().outputRpm(), subject.rpm, 0.2 * subject.rpm);
  }
  EXPECT_GT(enabled, 0) << "it turns on in each of these ticks";
}

INSTANTIATE_TEST_SUITE_P(All, EndingFamily,
                         ::testing::Combine(::testing::ValuesIn(kSubjects), ::testing::Bool(),
                                            ::testing::Values(1, 10)),
                         [](const auto& made) {
                           return std::string{std::get<0>(made.param).name} +
                                  (std::get<1>(made.param) ? "Ramp" : "Hold") +
                                  std::to_string(std::get<2>(made.param));
                         });

// Those that do not tell of a restart, and one whose timeout is long by itself.
const Subject kPatientSubjects[] = {
    {"Dji", "model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000", 0, false},
    {"VescWithoutItsBootFrame",
     "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_timeout_ms: 1000", 0, false, "",
     300.0},
    {"VescAtFiveHertz",
     "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, angle: none, feedback_hz: 5", 0, false,
     "", 300.0},
    {"LkTech", "model: LK-MG5010E-i10, id: 12, feedback_timeout_ms: 1000", 0, false},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit, feedback_timeout_ms: 1000", 0, false},
};

class PatientFamily : public Family {};

TEST_P(PatientFamily, ASilenceInWhichItMayHaveBeenRestartedEndsActive) {
  ASSERT_TRUE(activate(robot));
  turn(500);
  // Not heard, it has its boot frame lost, too; an LK-Tech within half a turn of a fresh count is as before.
  robot.simBus().silence(kMotor, true);
  turn(600);
  robot.simBus().silence(kMotor, false);
  turn(500);
  EXPECT_NE(status(), MotorStatus::kActive);
}

TEST_P(PatientFamily, NeitherALostFrameNorAPauseOfTheComputerEndsActive) {
  ASSERT_TRUE(activate(robot));
  turn(500);
  robot.simBus().silence(kMotor, true);
  turn(GetParam().name == std::string{"VescAtFiveHertz"} ? 150 : 60);
  robot.simBus().silence(kMotor, false);
  turn(500);
  EXPECT_EQ(status(), MotorStatus::kActive);
  robot.command(kMotor, {.mode = ControlMode::kVelocity, .value = GetParam().rpm});
  robot.tick(90);
  turn(500);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

INSTANTIATE_TEST_SUITE_P(All, PatientFamily, ::testing::ValuesIn(kPatientSubjects),
                         [](const auto& subject) { return std::string{subject.param.name}; });

class PatientHeldFamily : public HeldFamily {};

TEST_P(PatientHeldFamily, IsLetGoAfterASilenceInWhichItMayHaveBeenRestarted) {
  ASSERT_TRUE(isHeld());
  robot.simBus().silence(kMotor, true);
  robot.run(600);
  robot.simBus().silence(kMotor, false);
  robot.run(250);
  EXPECT_EQ(robot.motor(kMotor).acting, Acting::kNothing);
}

INSTANTIATE_TEST_SUITE_P(All, PatientHeldFamily, ::testing::ValuesIn(kPatientSubjects),
                         [](const auto& subject) { return std::string{subject.param.name}; });

std::vector<Subject> toldOfRestart() {
  std::vector<Subject> told;
  std::copy_if(std::begin(kSubjects), std::end(kSubjects), std::back_inserter(told),
               [](const Subject& subject) { return subject.told_of_restart; });
  return told;
}

INSTANTIATE_TEST_SUITE_P(All, RestartedFamily, ::testing::ValuesIn(toldOfRestart()),
                         [](const auto& subject) { return std::string{subject.param.name}; });

INSTANTIATE_TEST_SUITE_P(All, RestartedHeldFamily, ::testing::ValuesIn(toldOfRestart()),
                         [](const auto& subject) { return std::string{subject.param.name}; });

INSTANTIATE_TEST_SUITE_P(All, HeldFamily, ::testing::ValuesIn(kSubjects),
                         [](const auto& subject) { return std::string{subject.param.name}; });

INSTANTIATE_TEST_SUITE_P(All, Family, ::testing::ValuesIn(kSubjects),
                         [](const auto& subject) { return std::string{subject.param.name}; });

}  // namespace
}  // namespace rc10::test::family_test
