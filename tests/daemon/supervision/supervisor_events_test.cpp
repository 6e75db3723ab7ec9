// Every event to the last field: what, how grave, whose, and when.

#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_events_test {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;

constexpr std::int16_t kRobot = -1;
constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kYaw = 2;
constexpr Target kForwards{.mode = ControlMode::kVelocity, .value = 60.0};

constexpr std::int32_t number(auto name) { return static_cast<std::int32_t>(name); }
/// Status before, and the cause.
constexpr std::int32_t from(auto before, StopCause cause = StopCause::kNone) {
  return number(before) + 256 * number(cause);
}

struct Told {
  EventCode code;
  Severity severity;
  std::int16_t source;
  std::int32_t value;
  std::int32_t extra = 0;
  std::string client{};
  friend bool operator==(const Told&, const Told&) = default;
  friend void PrintTo(const Told& told, std::ostream* out) {
    *out << "event " << number(told.code) << ", severity " << number(told.severity) << ", source "
         << told.source << ", value " << told.value << ", extra " << told.extra << ", client '" << told.client
         << '\'';
  }
};
Told status(std::size_t motor, MotorStatus after, MotorStatus before) {
  return {EventCode::kMotorStatus, Severity::kInfo, static_cast<std::int16_t>(motor), number(after),
          from(before)};
}

/// `left` and `right` stop together.
RobotConfig robotOf(GroupConfig::Return on_return = GroupConfig::Return::kRequest) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[kLeft].fallback.on_timeout = FallbackAction::kBrake;
  config.buses[0].motors[kYaw].guard.overspeed_rpm = 100.0F;
  config.buses[0].motors[kYaw].rest.gained_rpm = 50.0F;
  config.groups.push_back(leftAndRight(on_return));
  return config;
}

class EventsTest : public ::testing::Test {
 protected:
  explicit EventsTest(const RobotConfig& config = robotOf()) : robot(config) {
    robot.run(5);
    (void)robot.events();
  }
  std::vector<Told> tick() {
    robot.tick();
    std::vector<Told> all;
    for (const auto& event : robot.events()) {
      EXPECT_EQ(event.time, robot.now());
      all.push_back({event.code, event.severity, event.source, event.value, event.extra,
                     std::string{event.client.view()}});
    }
    return all;
  }
  std::vector<Told> run(int ticks) {
    std::vector<Told> all;
    for (int i = 0; i < ticks; ++i)
      for (auto& told : tick()) all.push_back(std::move(told));
    return all;
  }
  void enable() {
    robot.order(Operation::kEnable);
    (void)robot.events();
  }
  std::vector<Told> ask(Operation operation, MotorSet motors, bool whole_robot = false) {
    Order order{};
    order.id = 7;
    order.operation = operation;
    order.motors = motors;
    order.client = "pilot";
    order.whole_robot = whole_robot;
    EXPECT_TRUE(robot.exchange().orders.push(order));
    return tick();
  }

  VirtualRobot robot;
};

TEST_F(EventsTest, EnablingIsToldInItsSteps) {
  auto all = ask(Operation::kEnable, MotorSet{}.set(kYaw));
  for (auto& told : run(10)) all.push_back(std::move(told));
  EXPECT_THAT(all, ElementsAre(status(kYaw, MotorStatus::kEnabling, MotorStatus::kReady),
                               status(kYaw, MotorStatus::kActive, MotorStatus::kEnabling)));
}

TEST_F(EventsTest, AnEstopNamesItsClientForEachMotorAndForTheRobot) {
  enable();
  const auto stopped = [](std::size_t motor) {
    auto told = status(motor, MotorStatus::kReady, MotorStatus::kActive);
    told.extra = from(MotorStatus::kActive, StopCause::kEstop);
    told.client = "pilot";
    return told;
  };
  EXPECT_THAT(ask(Operation::kEstop, {}),
              ElementsAre(stopped(kLeft), stopped(kRight), stopped(kYaw),
                          Told{EventCode::kRobotState, Severity::kError, kRobot, number(RobotStatus::kEstop),
                               from(RobotStatus::kRun, StopCause::kRequest), "pilot"}));
  EXPECT_THAT(run(5), ElementsAre());
  EXPECT_THAT(ask(Operation::kClear, MotorSet{}.set(kLeft).set(kRight).set(kYaw), true),
              ElementsAre(Told{EventCode::kRobotState, Severity::kInfo, kRobot, number(RobotStatus::kRun),
                               from(RobotStatus::kEstop), "pilot"}));
}

TEST_F(EventsTest, ACommandThatLapsesSaysWhatActsNow) {
  enable();
  robot.command(kLeft, kForwards, 2ms);
  EXPECT_THAT(run(3), ElementsAre(Told{EventCode::kCommandTimeout, Severity::kWarning, kLeft,
                                       number(FallbackAction::kBrake)}));
}

TEST_F(EventsTest, SilenceIsAnErrorOfWhatWasActiveOnly) {
  ask(Operation::kEnable, MotorSet{}.set(kYaw));
  (void)run(10);
  robot.freezeSimulation(true);
  auto lost = status(kYaw, MotorStatus::kOffline, MotorStatus::kActive);
  lost.severity = Severity::kError;
  lost.extra = from(MotorStatus::kActive, StopCause::kSilence);
  auto all = run(200);
  std::erase_if(all, [](const Told& told) { return told.code != EventCode::kMotorStatus; });
  EXPECT_THAT(all, ElementsAre(status(kLeft, MotorStatus::kOffline, MotorStatus::kReady),
                               status(kRight, MotorStatus::kOffline, MotorStatus::kReady), lost));
}

TEST_F(EventsTest, AReferenceThatIsLostIsAWarning) {
  robot.freezeSimulation(true);
  (void)run(200);  // long enough to lose a turn
  robot.freezeSimulation(false);
  EXPECT_THAT(run(3), Contains(Told{EventCode::kReferenceLost, Severity::kWarning, kYaw, 0}));
}

TEST_F(EventsTest, AFaultIsToldWithItsMotorsNewStatus) {
  enable();
  std::vector<Told> all;
  for (int i = 0; i < 2000 && robot.motor(kYaw).status == MotorStatus::kActive; ++i) {
    robot.command(kYaw, {.mode = ControlMode::kVelocity, .value = 200.0});
    for (auto& told : tick()) all.push_back(std::move(told));
  }
  auto fault = status(kYaw, MotorStatus::kFault, MotorStatus::kActive);
  fault.severity = Severity::kError;
  fault.extra = from(MotorStatus::kActive, StopCause::kFault);
  EXPECT_THAT(all,
              ElementsAre(Told{EventCode::kMotorFault, Severity::kError, kYaw, number(FaultCode::kOverspeed)},
                          fault));
}

TEST_F(EventsTest, ARefusedCommandNamesItsClientAndTheMotor) {
  enable();
  robot.commandAs("planner", 5, kRight, kForwards);
  (void)tick();
  robot.commandAs("second", 0, kRight, kForwards);
  EXPECT_THAT(tick(), ElementsAre(Told{EventCode::kNotOwner, Severity::kWarning, kRight, 0, 0, "second"}));
}

TEST_F(EventsTest, ASkippedTargetSaysItsModeAndItsMotorsStatus) {
  robot.command(kLeft, kForwards);
  EXPECT_THAT(tick(), ElementsAre(Told{EventCode::kSetpointSkipped, Severity::kWarning, kLeft,
                                       number(SkipReason::kNotActive),
                                       number(ControlMode::kVelocity) + 256 * number(MotorStatus::kReady)}));
}

TEST_F(EventsTest, AGroupSaysForWhichMotorItStops) {
  enable();
  const auto stops = [](Severity severity, std::size_t motor, GroupStop reason) {
    return Told{EventCode::kGroupStopped, severity, static_cast<std::int16_t>(motor), 0, number(reason)};
  };
  EXPECT_THAT(ask(Operation::kDisable, MotorSet{}.set(kRight)),
              Contains(stops(Severity::kInfo, kRight, GroupStop::kDisabled)));
  (void)run(500);
  enable();
  robot.simBus().silence(kRight, true);
  EXPECT_THAT(run(100), Contains(stops(Severity::kError, kRight, GroupStop::kLost)));
}

TEST_F(EventsTest, MovementAtRestIsToldWithItsSpeed) {
  auto load = robot.simBus().drive(kYaw).load();
  load.load_torque_nm = 0.3F;
  robot.simBus().setLoad(kYaw, load);
  std::vector<Told> all;
  float rpm = 0.0F;
  for (int i = 0; i < 5000 && all.empty(); ++i) {
    all = tick();
    rpm = robot.motor(kYaw).feedback.velocity_rpm;
  }
  EXPECT_THAT(all, ElementsAre(Told{EventCode::kMovesAtRest, Severity::kInfo, kYaw,
                                    static_cast<std::int32_t>(std::lround(rpm))}));
}

class RearmingEventsTest : public EventsTest {
 protected:
  RearmingEventsTest() : EventsTest(robotOf(GroupConfig::Return::kRearmAtRest)) {}
};

TEST_F(RearmingEventsTest, AGroupThatComesBackSaysSo) {
  enable();
  robot.simBus().silence(kRight, true);
  (void)run(100);
  robot.simBus().silence(kRight, false);
  EXPECT_THAT(run(1000), Contains(Told{EventCode::kGroupRearmed, Severity::kInfo, kLeft, 0}));
}

TEST(EventsOfAMissingDrive, SayItsId) {
  VirtualRobot robot{twoWheelsAndYaw()};
  robot.simBus().silence(kRight, true);
  robot.run(3100);
  for (const auto& event : robot.events()) {
    if (event.code != EventCode::kNeverHeard) continue;
    EXPECT_EQ(event.severity, Severity::kWarning);
    EXPECT_EQ(event.source, kRight);
    EXPECT_EQ(event.value, 2);
    EXPECT_EQ(event.extra, 0);
  }
}

}  // namespace
}  // namespace rc10::test::supervisor_events_test
