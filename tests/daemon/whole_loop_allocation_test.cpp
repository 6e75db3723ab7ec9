// Everything that the two real-time threads do, from the socket back to the socket, without one allocation.

#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "blackbox/memory_box.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/interfaces/can_intake.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::whole_loop_allocation_test {
namespace {

using namespace std::chrono_literals;

/// Intake and scheduler on one thread, over the socket pair of a simulated bus. The ticks have the time of
/// the clock, since that is what stamps are compared with. The drives are ahead of it.
class WholeLoopAllocationTest : public ::testing::Test {
 protected:
  WholeLoopAllocationTest() {
    auto config = twoWheelsAndYaw();
    // However long this computer is busy with something else, no motor goes offline.
    for (auto& motor : config.buses[0].motors) motor.feedback_timeout = 60s;
    robot = Robot::build(config).value();
    intake.emplace(*robot, inboxes, monotonicNow());
    scheduler = std::make_unique<Scheduler>(*robot, inboxes, exchange, 1ms, &recorder);
    for (int i = 0; i < 5; ++i) tick();
    Order enable{1, Operation::kEnable, MotorSet{0b111}, 0.0};
    exchange.orders.push(enable);
    tick();
    tick();
  }

  void tick() {
    drives_now += 1ms;
    robot->simPorts()[0]->step(drives_now);
    const auto now = monotonicNow();
    intake->drain(now);
    scheduler->tick(now);
  }

  /// 2,000 ticks with a command in each, a request now and then, and late ticks. Returns what they allocated.
  std::uint64_t run(bool with_canary) {
    Command command;
    command.client = "test";
    command.count = 2;
    command.setpoints[0] = {0, {.mode = ControlMode::kVelocity, .value = 60.0}};
    command.setpoints[1] = {2, {.mode = ControlMode::kAngle, .value = 45.0}};
    Order gains{3, Operation::kSetGains, MotorSet{0b111}, 0.0};
    gains.gains.count = 2;
    gains.gains.values[0] = {LoopGain::kVelocityKi, 0.5F};
    gains.gains.values[1] = {LoopGain::kAngleKp, 3.5F};
    const AllocGuard guard;
    for (int i = 0; i < 2000; ++i) {
      command.received = command.said = monotonicNow();
      command.deadline = command.received + 60s;
      exchange.commands.push(command);
      if (i % 500 == 100) exchange.orders.push({2, Operation::kZero, MotorSet{0b111}, 0.0});
      if (i % 500 == 300) exchange.orders.push(gains);
      if (i == 1000 && with_canary) canary = std::make_unique<int>(i);
      if (i % 700 == 600) scheduler->tick(monotonicNow(), 7);
      tick();
    }
    return guard.allocations();
  }

  std::array<BusInbox, kMaxBuses> inboxes;
  LinkExchange exchange;
  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  std::unique_ptr<Robot> robot;
  std::optional<CanIntake> intake;
  std::unique_ptr<Scheduler> scheduler;
  std::unique_ptr<int> canary;
  MonotonicTime drives_now = monotonicNow();
};

TEST_F(WholeLoopAllocationTest, TwoThousandTicksAllocateNothing) {
  EXPECT_EQ(run(false), 0U);
  // It was the whole loop: frames came in, motors acted, frames went out.
  const auto& snapshot = exchange.snapshot.read();
  EXPECT_GE(snapshot.buses[0].counters.rx_frames, 6000U);
  EXPECT_GE(snapshot.buses[0].counters.tx_frames, 4000U);
  EXPECT_EQ(snapshot.buses[0].counters.tx_dropped, 0U);
  EXPECT_EQ(snapshot.motors[0].status, MotorStatus::kActive);
  EXPECT_EQ(snapshot.motors[0].target.mode, ControlMode::kVelocity);
  EXPECT_EQ(snapshot.motors[2].target.mode, ControlMode::kAngle);
  EXPECT_GT(snapshot.missed_ticks, 0U);
  EXPECT_EQ(gainOf(*robot->motors()[2].motor->hostLoops(), LoopGain::kAngleKp), 3.5F);
  // All of it was recorded.
  const auto recording = box.recording();
  EXPECT_GE(all<blackbox::Frame>(recording).size(), 6000U);
  EXPECT_GE(all<blackbox::Setpoint>(recording).size(), 4000U);
  EXPECT_EQ(box.head().control.dropped, 0U);
}

TEST_F(WholeLoopAllocationTest, OneNewAmongTwoThousandTicksIsNoticed) { EXPECT_EQ(run(true), 1U); }

}  // namespace
}  // namespace rc10::test::whole_loop_allocation_test
