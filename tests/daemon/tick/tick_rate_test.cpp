// A scheduler above 1 kHz, on buses that have room for it: every tick has its answer, and times stay times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "config/load_config.hpp"
#include "daemon/threads/sim_loop.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::tick_rate_test {
namespace {

using namespace std::chrono_literals;

struct Wire {
  const char* name;
  int rate_hz;
  const char* motor;  ///< Its keys after the name.
};

void PrintTo(const Wire& wire, std::ostream* out) { *out << wire.name; }

constexpr const char* kMoteus = "model: moteus, id: 7, motor_kv_rpm_per_v: 100";
constexpr const char* kDamiao = "model: DM4310, id: 1, master_id: 17, can_fd: true";
// A moteus at 4000 Hz fills its bus: 88 to 106 %.
const Wire kWires[] = {
    {"Moteus2000", 2000, kMoteus}, {"Damiao2000", 2000, kDamiao}, {"Damiao4000", 4000, kDamiao}};

RobotConfig configOf(const Wire& wire) {
  auto outcome = parseRobotConfig(
      "robot: fast\nrealtime: preferred\nscheduler: {rate_hz: " + std::to_string(wire.rate_hz) +
          "}\nbuses:\n  - name: bench\n    type: sim\n    data_bitrate: 5000000\n    motors:\n      - {name: "
          "motor, on_timeout: coast, " +
          wire.motor + "}\n",
      "fast.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

class TickRate : public ::testing::TestWithParam<Wire> {
 protected:
  static constexpr std::size_t kMotor = 0;

  MotorStatus status() { return robot.motor(kMotor).status; }
  int ticks(Duration time) const { return static_cast<int>(time / config.period()); }
  void enable() {
    for (int i = 0; i < ticks(4s) && status() != MotorStatus::kReady; ++i) robot.tick();
    ASSERT_EQ(status(), MotorStatus::kReady);
    robot.order(Operation::kEnable);
    ASSERT_EQ(status(), MotorStatus::kActive);
  }
  void turn(Duration time) {
    robot.hold(kMotor, {.mode = ControlMode::kVelocity, .value = 30.0}, ticks(time));
  }

  RobotConfig config = configOf(GetParam());
  VirtualRobot robot{config};
};

TEST_P(TickRate, EveryTickSendsACommandAndHasTheAnswerToTheOneBefore) {
  enable();
  turn(1s);
  const auto before = robot.snapshot().buses[0].counters;
  turn(1s);
  const auto& after = robot.snapshot().buses[0].counters;
  const auto each = static_cast<std::uint64_t>(GetParam().rate_hz);
  EXPECT_EQ(after.tx_frames - before.tx_frames, each);
  EXPECT_EQ(after.rx_frames - before.rx_frames, each);
  EXPECT_LE(robot.now() - robot.motor(kMotor).feedback.received, config.period());
}

TEST_P(TickRate, TheDriveFollowsASpeed) {
  enable();
  turn(3s);
  EXPECT_NEAR(robot.simBus().drive(kMotor).physics().outputRpm(), 30.0, 3.0);
  EXPECT_NEAR(static_cast<double>(robot.motor(kMotor).feedback.velocity_rpm), 30.0, 3.0);
}

TEST_P(TickRate, ACommandEndsAfterItsTimeNotAfterTicks) {
  enable();
  turn(1s);
  int lasted = 0;  // the last command is valid for 50 ms
  while (robot.motor(kMotor).acting == Acting::kTarget && lasted < ticks(1s)) {
    robot.tick();
    ++lasted;
  }
  EXPECT_NEAR(lasted, ticks(50ms), 1);
}

TEST_P(TickRate, ASilentDriveIsOfflineAfterItsTimeNotAfterTicks) {
  enable();
  turn(1s);
  robot.simBus().silence(kMotor, true);
  int lasted = 0;
  while (status() != MotorStatus::kOffline && lasted < ticks(2s)) {
    robot.hold(kMotor, {.mode = ControlMode::kVelocity, .value = 30.0}, 1);
    ++lasted;
  }
  EXPECT_NEAR(lasted, ticks(config.buses[0].motors[kMotor].feedback_timeout), 2);
}

TEST_P(TickRate, AStopWaitsFiftyMillisecondsForEchoesThatDoNotCome) {
  robot.run(10);
  robot.inboxes()[0].echo_reads.store(1);
  robot.scheduler().beginStop();
  int lasted = 0;
  while (!robot.scheduler().stopped() && lasted < ticks(1s)) {
    robot.tick();
    ++lasted;
  }
  EXPECT_EQ(lasted, ticks(50ms));
}

TEST(SimulationGrid, HasAStepHalfwayBetweenTwoTicksThatAreShorterThanAMillisecond) {
  const auto fast = SimLoop::gridBeside({.period = 250us, .offset = 75us});
  EXPECT_EQ(fast.period, 250us);
  EXPECT_EQ(fast.offset, 200us);
}

TEST(SimulationGrid, StepsOnceAMillisecondForSlowTicks) {
  const auto slow = SimLoop::gridBeside({.period = 10ms, .offset = 3ms});
  EXPECT_EQ(slow.period, 1ms);
  EXPECT_EQ(slow.offset, 3500us);
}

INSTANTIATE_TEST_SUITE_P(Wires, TickRate, ::testing::ValuesIn(kWires),
                         [](const auto& wire) { return std::string{wire.param.name}; });

}  // namespace
}  // namespace rc10::test::tick_rate_test
