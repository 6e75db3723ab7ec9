// A whole robot with modules: a mecanum chassis, a remote on a serial port and a planner, on simulated
// drives.

#include <cmath>

#include <gmock/gmock.h>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"
#include "module/dbus_protocol.hpp"

namespace rc10::test::driven_robot_test {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRobot = R"(
robot: driven
realtime: preferred
profiles:
  wheel: {model: M3508, zero: power_on, on_timeout: brake, simulated: {inertia_kg_m2: 0.02}}
buses:
  - name: chassis
    type: sim
    motors:
      - {name: front_left, profile: wheel, id: 1}
      - {name: front_right, profile: wheel, id: 2, direction: -1}
      - {name: rear_left, profile: wheel, id: 3}
      - {name: rear_right, profile: wheel, id: 4, direction: -1}
modules:
  - name: remote
    type: remote
    priority: 100
    port: /dev/ttyX
    protocol: dbus
    arm_channel: left_switch
    sticks:
      - {channel: right_y, to: base.vx_m_s, scale: 1}
      - {channel: left_x, to: base.wz_deg_s, scale: -90}
  - name: base
    type: mecanum_chassis
    wheels: {front_left: front_left, front_right: front_right, rear_left: rear_left, rear_right: rear_right}
    wheel_radius_m: 0.076
    track_m: 0.5
    wheelbase_m: 0.4
    max_speed_m_s: 1.5
    max_turn_deg_s: 180
    max_acceleration_m_s2: 2
    max_turn_acceleration_deg_s2: 360
)";

class DrivenRobot : public ::testing::Test {
 protected:
  enum Output : std::size_t { kX, kY, kHeading, kVx };
  static constexpr std::size_t kBase = 1;

  DrivenRobot() : robot_(parseRobotConfig(kRobot, "driven.yaml").config.value()) {
    channel().state.store(SerialState::kOpen);
    channel().opening.store(1);
  }

  SerialChannel& channel() { return (*robot_.robot().serialChannels())[0]; }
  void run(int ticks, bool remote_talks = true) {
    for (int i = 0; i < ticks; ++i) {
      if (remote_talks && ++since_frame_ >= 14) {
        since_frame_ = 0;
        SerialChunk chunk;
        chunk.received = robot_.now();
        chunk.opening = 1;
        const auto frame = DbusProtocol::encode(remote_);
        std::copy(frame.begin(), frame.end(), chunk.data.begin());
        chunk.size = static_cast<std::uint16_t>(frame.size());
        ASSERT_TRUE(channel().chunks.push(chunk));
      }
      if (!std::isnan(planner_vx_m_s_)) plan();
      robot_.tick();
    }
  }
  void plan() {
    SignalMessage message;
    message.client = "planner";
    message.session = 9;
    message.deadline = robot_.now() + 50ms;
    message.module = kBase;
    message.values.fill(kNoSignal);
    message.values[0] = planner_vx_m_s_;
    message.values[1] = planner_vy_m_s_;
    ASSERT_TRUE(robot_.exchange().signals.push(message));
  }
  void arm() {
    remote_.left_switch = Dr16Input::Switch::kDown;
    run(40);
    remote_.left_switch = Dr16Input::Switch::kUp;
    run(60);
  }
  double output(Output output) { return robot_.snapshot().modules[kBase].outputs[output]; }
  std::string_view owner() { return robot_.snapshot().modules[kBase].owner.view(); }
  bool allAre(MotorStatus status) {
    const auto& motors = robot_.snapshot().motors;
    return std::all_of(motors.begin(), motors.begin() + 4,
                       [&](const auto& motor) { return motor.status == status; });
  }

  VirtualRobot robot_;
  Dr16Input remote_;
  int since_frame_ = 0;
  double planner_vx_m_s_ = kNoSignal;
  double planner_vy_m_s_ = 0.0;
};

TEST_F(DrivenRobot, ThePlannerDrivesASquareAndOdometryReturnsToTheStart) {
  run(20);
  (void)robot_.order(Operation::kEnable);
  // The first stand is for the soft start.
  for (const auto& [vx, vy] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
    planner_vx_m_s_ = vx;
    planner_vy_m_s_ = vy;
    run(1000, false);
    planner_vx_m_s_ = 0.0;
    planner_vy_m_s_ = 0.0;
    run(1000, false);
  }
  // Each side is as long as the others, as far as the loops are alike in both directions.
  EXPECT_NEAR(output(kX), 0.0, 0.01);
  EXPECT_NEAR(output(kY), 0.0, 0.01);
  EXPECT_NEAR(std::remainder(output(kHeading), 360.0), 0.0, 0.5);
}

TEST_F(DrivenRobot, TheRemoteEnablesTheRobotAndBeatsThePlannerInTheNextTick) {
  run(100);
  EXPECT_TRUE(allAre(MotorStatus::kReady)) << "a switch that is up at the start enables nothing";
  arm();
  EXPECT_TRUE(allAre(MotorStatus::kActive));
  remote_.right_vertical = 660;
  planner_vx_m_s_ = -0.5;
  run(1500);
  EXPECT_EQ(owner(), "remote");
  EXPECT_NEAR(output(kVx), 1.0, 0.05);
  remote_.left_switch = Dr16Input::Switch::kDown;
  run(50);
  EXPECT_TRUE(allAre(MotorStatus::kReady));
  EXPECT_EQ(owner(), "planner") << "who may go on as soon as the remote has let go";
}

TEST_F(DrivenRobot, TheRemoteDisablesWhatAProgramHasEnabled) {
  run(100);
  (void)robot_.order(Operation::kEnable);
  run(200);
  ASSERT_TRUE(allAre(MotorStatus::kActive));
  remote_.left_switch = Dr16Input::Switch::kDown;
  run(50);
  EXPECT_TRUE(allAre(MotorStatus::kReady));
}

TEST_F(DrivenRobot, ALostRemoteBringsTheRobotToRestAndDisablesItLater) {
  run(100);
  arm();
  remote_.right_vertical = 660;
  run(1500);
  ASSERT_GT(output(kVx), 0.9);
  run(145, false);  // 100 ms until it is lost, 20 until the chassis is silent, 20 until the wheels fall back
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(robot_.motor(i).target.mode, ControlMode::kCoast);
  run(800, false);
  EXPECT_NEAR(output(kVx), 0.0, 0.05);
  EXPECT_TRUE(allAre(MotorStatus::kActive));
  run(300, false);
  EXPECT_TRUE(allAre(MotorStatus::kReady));
  run(200);
  EXPECT_TRUE(allAre(MotorStatus::kReady)) << "back, with the switch still up";
  arm();
  EXPECT_TRUE(allAre(MotorStatus::kActive)) << "by the switch alone";
}

TEST_F(DrivenRobot, AfterAPowerCutTheDriverRecoversItWithTheSwitchAlone) {
  run(100);
  arm();
  remote_.right_vertical = 660;
  run(500);
  robot_.freezeSimulation(true);
  run(300);
  EXPECT_TRUE(allAre(MotorStatus::kOffline));
  robot_.freezeSimulation(false);
  run(500);
  EXPECT_FALSE(allAre(MotorStatus::kActive)) << "nothing comes back by itself";
  remote_.right_vertical = 0;
  arm();
  run(500);
  EXPECT_TRUE(allAre(MotorStatus::kActive));
}

TEST_F(DrivenRobot, AnUnpluggedPortMidFrameIsSurvived) {
  run(100);
  arm();
  SerialChunk half;
  half.received = robot_.now();
  half.opening = 1;
  half.size = 7;
  ASSERT_TRUE(channel().chunks.push(half));
  channel().state.store(SerialState::kAbsent);
  run(200, false);
  EXPECT_TRUE(allAre(MotorStatus::kActive));
  channel().state.store(SerialState::kOpen);
  remote_.right_vertical = 660;
  run(1000);
  EXPECT_GT(output(kVx), 0.9);
}

}  // namespace
}  // namespace rc10::test::driven_robot_test
