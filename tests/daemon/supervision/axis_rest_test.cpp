// Every family on a whole robot: a drive that is told to rest and does not, and what is none of its fault;
// somebody else who commands our drives, and who only asks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "config/load_config.hpp"
#include "config/report/report.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/virtual_robot.hpp"
#include "link/words.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::axis_rest_test {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::Field;

struct Subject {
  const char* name;
  const char* motor;     ///< Its keys after the name.
  const char* question;  ///< candump text of one that another tool might ask; empty: none can be asked.
  const char* bus = "";
  double rpm = 30.0;
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

const Subject kSubjects[] = {
    {"M3508", "model: M3508, id: 1, zero: power_on", "", "", 100.0},
    {"M2006", "model: M2006, id: 2, zero: power_on", "", "", 100.0},
    {"GM6020", "model: GM6020, id: 5, command: current", "", "", 60.0},
    {"GM6020ByVolts", "model: GM6020, id: 6, command: voltage", "", "", 60.0},
    {"Vesc",
     "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500, "
     "motor_current_max_a: 40, kv_rpm_per_v: 190",
     "0000110A#00", "", 300.0},
    {"DamiaoMit", "model: DM4310, id: 1, master_id: 17", "7FF#01003308"},
    {"DamiaoVelocity", "model: DM8009, id: 2, master_id: 18, control: velocity", "7FF#02003308"},
    {"RobStride", "model: RS00, id: 3", "11000403#1970000000000000"},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit", ""},
    {"CubeMarsServo", "model: AK80-9, id: 5", ""},
    {"Moteus", "model: moteus, id: 7, motor_kv_rpm_per_v: 100", "00008107#110011011F01",
     "data_bitrate: 5000000\n    "},
    {"OdriveS1",
     "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
     "telemetry_hz: 100",
     "103#"},
    {"MyActuator", "model: RMD-X8-20, id: 11", "14B#9C00000000000000"},
    {"LkTech", "model: LK-MG5010E-i10, id: 12", "14C#9A00000000000000"},
};

std::string textOf(const Subject& subject, const char* keys = "") {
  return std::string{"robot: rest\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    "} +
         subject.bus + "motors:\n      - {name: motor, " + subject.motor + keys + "}\n";
}

RobotConfig configOf(const std::string& text) {
  auto outcome = parseRobotConfig(text, "rest.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

class RestTest : public ::testing::TestWithParam<Subject> {
 protected:
  static constexpr std::size_t kMotor = 0;

  MotorStatus status() { return robot.motor(kMotor).status; }
  FaultCode fault() { return robot.motor(kMotor).fault; }
  bool enable() {
    for (int attempt = 0; attempt < 5; ++attempt) {
      robot.run(1000);
      robot.order(Operation::kEnable);
      if (status() == MotorStatus::kActive) return true;
    }
    return false;
  }
  Target turning() const { return {.mode = ControlMode::kVelocity, .value = GetParam().rpm}; }

  void carry(const std::vector<CanFrame>& frames) {
    for (const auto& frame : frames) robot.simBus().receive(frame);
  }
  /// Its targets in this number of ticks of being driven.
  std::vector<CanFrame> commandsOf(int ticks) {
    std::vector<CanFrame> all;
    for (int i = 0; i < ticks; ++i) {
      robot.command(kMotor, turning());
      robot.tick();
      const auto frames = robot.takeFrames();
      carry(frames);
      all.insert(all.end(), frames.begin(), frames.end());
    }
    return all;
  }
  /// A drive that goes on with what it was told before, by any sender.
  void goOn(const std::vector<CanFrame>& commands, int ticks) {
    for (int i = 0; i < ticks && fault() != FaultCode::kNotAtRest; ++i) {
      robot.tick();
      (void)robot.takeFrames();
      carry(commands);
      ++went_on_ticks;
    }
  }
  /// It steers the drive, and does not say rest.
  bool commandsIt(const CanFrame& frame) {
    const auto& steers = robot.robot().motors()[kMotor].steers;
    const bool steer = std::any_of(steers.begin(), steers.end(),
                                   [&](const FrameFilter& filter) { return accepts(filter, frame); });
    return steer && frame.type == FrameType::kData && !robot.robot().buses()[0].bus->isRest(frame);
  }
  void foreign(CanFrame frame, bool here = false) {
    frame.received = robot.now();
    frame.sent_here = here;
    ASSERT_TRUE(robot.inboxes()[0].frames.push(frame));
  }
  void load(double torque_nm) {
    auto load = robot.simBus().drive(0).load();
    load.load_torque_nm = static_cast<float>(torque_nm);
    robot.simBus().setLoad(0, load);
  }

  VirtualRobot robot{configOf(textOf(GetParam()))};
  int went_on_ticks = 0;
};

// Without a load, with all its current: at its no-load speed nothing changes but the angle, and the field of
// some drives' angles ends.
TEST_P(RestTest, AShaftAtItsFullSpeedIsNotTakenForFrozenFeedback) {
  ASSERT_TRUE(enable());
  const bool by_current = robot.robot().motors()[kMotor].motor->modes().contains(ControlMode::kCurrent);
  robot.hold(kMotor, by_current ? Target{.mode = ControlMode::kCurrent, .value = 200.0} : turning(), 6000);
  EXPECT_EQ(fault(), FaultCode::kNone);
  EXPECT_EQ(status(), MotorStatus::kActive);
}

TEST_P(RestTest, ADriveThatGoesOnPushingIsAFault) {
  const auto rest = configOf(textOf(GetParam())).buses[0].motors[0].rest;
  ASSERT_TRUE(enable());
  robot.hold(kMotor, turning(), 300);
  robot.simBus().stall(0, true);
  robot.hold(kMotor, turning(), 1500);  // against a wall, with all it has
  ASSERT_GT(std::fabs(robot.simBus().drive(0).physics().currentA()), 0.0);
  const auto commands = commandsOf(20);
  Order order;
  order.operation = Operation::kDisable;
  order.motors.set(kMotor);
  ASSERT_TRUE(robot.exchange().orders.push(order));
  goOn(commands, 600);
  if (!(rest.current_a > 0.0F)) {
    EXPECT_NE(fault(), FaultCode::kNotAtRest) << "its feedback cannot tell: docs/motors.md";
    return;
  }
  ASSERT_EQ(fault(), FaultCode::kNotAtRest);
  EXPECT_EQ(status(), MotorStatus::kFault);
  EXPECT_LE(went_on_ticks, 160 + 2 * static_cast<int>(rest.time / 1ms) - 100);
}

TEST_P(RestTest, ADriveThatRestsIsNoneHoweverItTurns) {
  ASSERT_TRUE(enable());
  for (const auto operation : {Operation::kDisable, Operation::kEstop}) {
    robot.hold(kMotor, turning(), 1000);
    robot.order(operation);
    robot.run(1500);                                        // it runs down
    for (const double torque_nm : {0.3, -0.6, 0.0, 2.0}) {  // a hand, an arm that sinks
      load(torque_nm);
      robot.run(500);
    }
    load(0.0);
    robot.simBus().stall(0, true);
    robot.run(300);
    robot.simBus().stall(0, false);
    EXPECT_NE(status(), MotorStatus::kFault) << link::faultText(static_cast<std::int32_t>(fault()));
    robot.run(1000);
    robot.order(Operation::kClear);
    ASSERT_TRUE(enable());
  }
}

TEST_P(RestTest, ARestFrameThatIsLostIsRepeatedInTheNextTick) {
  const auto& physics = robot.simBus().drive(kMotor).physics();
  for (const auto operation : {Operation::kDisable, Operation::kEstop}) {
    for (const int more_ticks : {0, 1}) {  // drives that speak when asked are asked by turns
      ASSERT_TRUE(enable());
      robot.simBus().stall(0, true);
      robot.hold(kMotor, turning(), 400 + more_ticks);
      const double pushed_a = std::fabs(physics.currentA());
      ASSERT_GT(pushed_a, 0.1);
      Order order;
      order.operation = operation;
      order.motors.set(kMotor);
      ASSERT_TRUE(robot.exchange().orders.push(order));
      robot.tick();
      ASSERT_FALSE(robot.takeFrames().empty());
      robot.tick();
      carry(robot.takeFrames());
      for (int i = 0; i < 10; ++i) {  // less than the time-out of any drive
        robot.tick();
        (void)robot.takeFrames();
      }
      EXPECT_LT(std::fabs(physics.currentA()), 0.05 * pushed_a) << more_ticks;
      robot.simBus().stall(0, false);
      robot.run(100);
      OrderResult answered;
      while (robot.exchange().results.pop(answered)) continue;
      robot.order(Operation::kClear);
    }
  }
}

TEST_P(RestTest, SomebodyElsesCommandsAreAFaultAndRestGoesOnBeingSent) {
  robot.run(1000);
  std::vector<CanFrame> of_ready;  // some drives speak only when asked, by a frame that could command them
  for (int i = 0; i < 200; ++i) {
    robot.tick();
    const auto frames = robot.takeFrames();
    carry(frames);
    of_ready.insert(of_ready.end(), frames.begin(), frames.end());
  }
  ASSERT_TRUE(enable());
  robot.hold(kMotor, turning(), 200);
  std::vector<CanFrame> commands;
  for (const auto& frame : commandsOf(60))
    if (commandsIt(frame)) commands.push_back(frame);
  ASSERT_GE(commands.size(), 3U);
  foreign(commands[0]);
  robot.run(120);
  foreign(commands[0]);
  robot.run(60);
  foreign(commands[1]);
  robot.run(30);
  EXPECT_NE(fault(), FaultCode::kForeignCommands) << "not three within 100 ms";
  robot.run(200);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NE(fault(), FaultCode::kForeignCommands);
    foreign(commands[i], i == 0);
    robot.run(1);
  }
  EXPECT_EQ(fault(), FaultCode::kForeignCommands);
  robot.run(2);
  (void)robot.takeFrames();
  const auto wasOfReady = [&of_ready](const CanFrame& frame) {
    return std::any_of(of_ready.begin(), of_ready.end(), [&frame](const CanFrame& other) {
      return other.id == frame.id && std::ranges::equal(other.payload(), frame.payload());
    });
  };
  std::size_t sent = 0;
  for (int i = 0; i < 60; ++i) {
    foreign(commands[0]);
    robot.tick();
    for (const auto& frame : robot.takeFrames()) {
      ++sent;
      EXPECT_TRUE(!commandsIt(frame) || wasOfReady(frame)) << describe(frame.id);
    }
  }
  EXPECT_EQ(fault(), FaultCode::kForeignCommands);
  EXPECT_GT(sent, 0U);
}

TEST_P(RestTest, RestFramesOfOthersAndQuestionsAreNone) {
  ASSERT_TRUE(enable());
  std::array<CanFrame, kMaxFramesPerPacker> frames{};
  const auto& packers = robot.robot().buses()[0].bus->packers();
  const auto counted = [this] { return robot.snapshot().buses[0].counters.rx_frames; };
  const auto before = counted();
  std::uint64_t rests = 0;
  for (int i = 0; i < 300; ++i) {
    for (const auto* packer : packers) {
      const auto count = packer->packRest(frames);
      for (std::size_t n = 0; n < count; ++n) foreign(frames[n], true);
      rests += count;
    }
    if (*GetParam().question != '\0') foreign(frameOf(GetParam().question));
    robot.command(kMotor, turning());
    robot.tick();
  }
  EXPECT_EQ(status(), MotorStatus::kActive) << link::faultText(static_cast<std::int32_t>(fault()));
  ASSERT_GE(rests, 300U);
  constexpr std::uint64_t kOwnReports =
      30;  // of the slowest drive: more than the rest frames that may be lost
  EXPECT_GE(counted(), before + rests + kOwnReports) << "they were heard";
}

INSTANTIATE_TEST_SUITE_P(All, RestTest, ::testing::ValuesIn(kSubjects),
                         [](const auto& subject) { return std::string{subject.param.name}; });

class ShortBufferTest : public RestTest {};

// A vendor's tool at the USB of another VESC: COMM_FORWARD_CAN, and a command of five bytes.
TEST_P(ShortBufferTest, ACommandThatAnotherDrivePassesOnIsSomebodyElses) {
  ASSERT_TRUE(enable());
  for (const char* question : {"0000080A#640004", "0000080A#64003200008000"}) {
    for (int i = 0; i < 10; ++i) {
      foreign(frameOf(question));
      robot.hold(kMotor, turning(), 2);
    }
    EXPECT_EQ(status(), MotorStatus::kActive) << question;
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(status(), MotorStatus::kActive);
    const std::array frames{"0000080A#640008000003E8", "000008FF#640006000003E8", "0000080A#640054000003E8"};
    foreign(frameOf(frames[static_cast<std::size_t>(i)]));
    robot.hold(kMotor, turning(), 2);
  }
  EXPECT_EQ(fault(), FaultCode::kForeignCommands);
}

INSTANTIATE_TEST_SUITE_P(Vesc, ShortBufferTest, ::testing::Values(kSubjects[4]),
                         [](const auto& subject) { return std::string{subject.param.name}; });

// ---- The robot

constexpr std::string_view kRobot = R"(
robot: rest
realtime: preferred
buses:
  - name: chassis
    type: sim
    motors:
      - {name: left, model: M3508, id: 1, zero: power_on, on_estop: ESTOP, on_disable: DISABLE}
      - {name: right, model: M3508, id: 2, zero: power_on}
      - {name: far, model: M3508, id: 5, zero: power_on}
groups:
  - {name: drive, motors: [left, right]}
)";

class RestOfARobotTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kLeft = 0;
  static constexpr std::size_t kRight = 1;
  static constexpr std::size_t kFar = 2;

  void start(const char* more = "", const char* estop = "coast", const char* disable = "coast") {
    std::string text{kRobot};
    text.replace(text.find("ESTOP"), 5, estop);
    text.replace(text.find("DISABLE"), 7, disable);
    robot = std::make_unique<VirtualRobot>(configOf(text + more));
    robot->run(10);
    robot->order(Operation::kEnable);
    ASSERT_EQ(status(kFar), MotorStatus::kActive);
  }
  MotorStatus status(std::size_t motor) { return robot->motor(motor).status; }
  /// Instead of what it is told, 5 A for `left` reach its drive.
  void push(int ticks) {
    const CanFrame frame = makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{0x10, 0x00});
    for (int i = 0; i < ticks; ++i) {
      robot->command(kFar, {.mode = ControlMode::kVelocity, .value = 60.0});
      robot->tick();
      for (const auto& sent : robot->takeFrames())
        robot->simBus().receive(sent.id == frame.id ? frame : sent);
    }
  }

  std::unique_ptr<VirtualRobot> robot;
};

TEST_F(RestOfARobotTest, TheGroupStopsAndTheOthersGoOn) {
  start();
  MotorSet left;
  left.set(kLeft);
  robot->simBus().stall(0, true);
  robot->orderFor(left, Operation::kDisable);  // its group rests with it
  push(150);
  EXPECT_EQ(status(kLeft), MotorStatus::kFault);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kNotAtRest);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
  EXPECT_EQ(robot->orderFor(MotorSet{}.set(kRight), Operation::kEnable).motors[kRight], Refusal::kGroup);
  EXPECT_EQ(status(kFar), MotorStatus::kActive);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kRun);
  EXPECT_GT(robot->scheduler().beats(), 0U);
  Order clear;
  clear.operation = Operation::kClear;
  clear.motors.set(kLeft);
  ASSERT_TRUE(robot->exchange().orders.push(clear));
  push(2);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  push(150);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kNotAtRest) << "it still does not rest";
}

TEST_F(RestOfARobotTest, AnActiveMotorThatNobodyCommandsIsWatchedAsWell) {
  start();
  robot->simBus().stall(0, true);
  push(150);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kNotAtRest);
  EXPECT_EQ(status(kRight), MotorStatus::kReady) << "its group";
  EXPECT_EQ(status(kFar), MotorStatus::kActive);
}

TEST_F(RestOfARobotTest, AnEstopOfTheRobotAndTheEndOfTheHeartbeatAreKeys) {
  start("on_unrest: estop\n");
  robot->simBus().stall(0, true);
  push(150);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kEstop);
  EXPECT_EQ(robot->snapshot().stop.cause, StopCause::kFault);
  EXPECT_EQ(robot->snapshot().stop.by.view(), "left");
  auto beats = robot->scheduler().beats();
  robot->run(10);
  EXPECT_EQ(robot->scheduler().beats(), beats + 10);

  start("on_unrest: heartbeat\nheartbeat_gpio: {chip: gpiochip0, line: 1}\n");
  robot->simBus().stall(0, true);
  push(150);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kEstop);
  beats = robot->scheduler().beats();
  robot->simBus().stall(0, false);
  robot->run(1000);
  EXPECT_EQ(robot->scheduler().beats(), beats);
  robot->order(Operation::kClear);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kRun);
  robot->run(10);
  EXPECT_GE(robot->scheduler().beats(), beats + 10);
}

TEST_F(RestOfARobotTest, AFallbackThatBrakesOrHoldsIsNoRest) {
  for (const char* action : {"brake", "hold", "damp"}) {
    start("", action);
    robot->hold(kLeft, {.mode = ControlMode::kVelocity, .value = 100.0}, 300);
    robot->order(Operation::kEstop);
    auto load = robot->simBus().drive(0).load();
    load.load_torque_nm = 1.5F;
    robot->simBus().setLoad(0, load);
    robot->run(3000);
    EXPECT_EQ(status(kLeft), MotorStatus::kReady) << action;
  }
}

TEST_F(RestOfARobotTest, WhatPullsAtRestIsToldOnce) {
  start();
  robot->order(Operation::kDisable);
  (void)robot->events();
  auto load = robot->simBus().drive(0).load();
  load.load_torque_nm = 1.0F;
  robot->simBus().setLoad(0, load);
  robot->run(2000);
  const auto events = robot->events();
  EXPECT_EQ(std::count_if(events.begin(), events.end(),
                          [](const Event& e) { return e.code == EventCode::kMovesAtRest; }),
            1);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
}

TEST_F(RestOfARobotTest, AForeignFrameConcernsTheMotorsOfItsIdAlone) {
  start();
  for (int i = 0; i < 3; ++i) {
    CanFrame frame = makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{0, 0, 0, 0, 1, 0});
    frame.received = robot->now();
    ASSERT_TRUE(robot->inboxes()[0].frames.push(frame));
    robot->command(kFar, {.mode = ControlMode::kVelocity, .value = 60.0});
    robot->tick();
  }
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kForeignCommands);
  EXPECT_EQ(robot->motor(kRight).fault, FaultCode::kForeignCommands);
  EXPECT_EQ(status(kFar), MotorStatus::kActive) << "0x1FF";
  const auto events = robot->events();
  EXPECT_THAT(events, Contains(Field(&Event::code, EventCode::kMotorFault)));
  const auto found = std::find_if(events.begin(), events.end(),
                                  [](const Event& e) { return e.code == EventCode::kMotorFault; });
  EXPECT_THAT(describe(*found), ::testing::HasSubstr("(0x200) from another node"));
}

TEST_F(RestOfARobotTest, FramesOfOursThatTheWireDoublesAreNobodyElses) {
  start();
  for (int i = 0; i < 100; ++i) {
    robot->command(kLeft, {.mode = ControlMode::kVelocity, .value = 60.0});
    robot->command(kFar, {.mode = ControlMode::kVelocity, .value = 60.0});
    robot->tick();
    for (CanFrame frame : robot->takeFrames()) {
      frame.received = robot->now();
      ASSERT_TRUE(robot->inboxes()[0].frames.push(frame));
    }
  }
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  EXPECT_EQ(status(kFar), MotorStatus::kActive);
  EXPECT_GT(robot->snapshot().buses[0].counters.rx_foreign, 100U) << "they are counted all the same";
}

TEST_F(RestOfARobotTest, HowManyForeignFramesAreAFaultIsAKey) {
  for (const auto& [keys, frames, stops] :
       {std::tuple{"foreign_frames: 0", 200, false}, std::tuple{"foreign_frames: 1", 1, true},
        std::tuple{"foreign_frames: 5, foreign_ms: 10", 4, false},
        std::tuple{"foreign_frames: 5, foreign_ms: 10", 5, true}}) {
    std::string text{kRobot};
    text.replace(text.find("ESTOP"), 5, "coast");
    text.replace(text.find("DISABLE"), 7, "coast");
    std::string lines{keys};
    if (const auto comma = lines.find(", "); comma != std::string::npos) lines.replace(comma, 2, "\n    ");
    text.replace(text.find("motors:\n"), 8, lines + "\n    motors:\n");
    robot = std::make_unique<VirtualRobot>(configOf(text));
    robot->run(10);
    for (int i = 0; i < frames; ++i) {
      CanFrame frame = makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{1});
      frame.received = robot->now();
      ASSERT_TRUE(robot->inboxes()[0].frames.push(frame));
      robot->tick();
    }
    EXPECT_EQ(status(kLeft) == MotorStatus::kFault, stops) << keys << ", " << frames;
  }
}

TEST(RestKeys, ADriveThatCannotTellTakesNoneAndTheReportSaysSo) {
  const auto text = [](const char* motor) {
    return std::string{
               "robot: rest\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"} +
           "      - {name: motor, " + motor + "}\n";
  };
  const char* odrive =
      "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600";
  EXPECT_TRUE(parseRobotConfig(text(odrive), "rest.yaml").config);
  EXPECT_THAT(rc10::describe(configOf(text(odrive))),
              ::testing::HasSubstr("note: whether motor rests when told"));
  EXPECT_THAT(rc10::describe(configOf(text("model: M3508, id: 1"))),
              ::testing::Not(::testing::HasSubstr("is not verified")));
  const auto refused =
      parseRobotConfig(text((std::string{odrive} + ", rest_current_a: 2").c_str()), "rest.yaml");
  EXPECT_THAT(refused.errorText(), ::testing::HasSubstr("reports no current with a sign"));
  const auto slow = configOf(text((std::string{odrive} + ", telemetry_hz: 10").c_str()));
  EXPECT_EQ(slow.buses[0].motors[0].rest.time, 300ms);
  const auto wheel = configOf(text("model: M3508, id: 1, rest_current_a: 0.4, rest_ms: 50"));
  EXPECT_FLOAT_EQ(wheel.buses[0].motors[0].rest.current_a, 0.4F);
  EXPECT_EQ(wheel.buses[0].motors[0].rest.time, 50ms);
  EXPECT_FLOAT_EQ(configOf(text("model: M3508, id: 1")).buses[0].motors[0].rest.current_a, 1.0F);
  EXPECT_FLOAT_EQ(configOf(text("model: M3508, id: 1, current_limit_a: 1")).buses[0].motors[0].rest.current_a,
                  0.5F);
  const auto heartbeat =
      parseRobotConfig("on_unrest: heartbeat\n" + text("model: M3508, id: 1"), "rest.yaml");
  EXPECT_THAT(heartbeat.errorText(), ::testing::HasSubstr("add heartbeat_gpio"));
}

}  // namespace
}  // namespace rc10::test::axis_rest_test
