#include "daemon/exchange/tick_trace.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "daemon/clients/trace_desk.hpp"
#include "daemon/link_rig.hpp"
#include "daemon/tick/tick_tracer.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::tick_trace_test {
namespace {

std::uint16_t reading(std::string_view name) {
  const auto& all = link::kTraceReadings;
  return static_cast<std::uint16_t>(std::find(all.begin(), all.end(), name) - all.begin());
}

link::TraceSignal signal(std::uint16_t motor, std::string_view name) {
  return {link::TraceSource::kMotor, motor, reading(name)};
}

link::TraceChoice choiceOf(std::initializer_list<link::TraceSignal> signals) {
  link::TraceChoice choice;
  for (const auto& one : signals) choice.signals[choice.signal_count++] = one;
  return choice;
}

// ---- The scheduler's side

TEST(TickTrace, EveryTickHasItsRowWithTheChosenSignals) {
  VirtualRobot robot(twoWheelsAndYaw());
  auto& trace = robot.exchange().trace;
  robot.run(20);
  EXPECT_EQ(trace.ticks.read_available(), 0U);  // nothing chosen

  TraceChoice choice{.generation = 7, .count = 2, .signals = {}};
  choice.signals[0] = signal(2, "angle_deg");
  choice.signals[1] = signal(0, "status");
  trace.choice.slot() = choice;
  trace.choice.publish();
  TracedTick row;
  std::int64_t last = -1;
  for (int i = 0; i < 50; ++i) {
    robot.tick();
    ASSERT_TRUE(trace.ticks.pop(row));
    EXPECT_EQ(row.generation, 7U);
    EXPECT_EQ(row.row.tick, static_cast<std::int64_t>(robot.snapshot().tick));
    if (last >= 0) {
      EXPECT_EQ(row.row.tick, last + 1);
    }
    last = row.row.tick;
    EXPECT_EQ(row.row.values[0], static_cast<double>(robot.motor(2).feedback.angle_deg));
    EXPECT_EQ(row.row.values[1], static_cast<double>(MotorStatus::kReady));
    EXPECT_FALSE(trace.ticks.pop(row));
  }
}

TEST(TickTrace, RowsThatFindNoRoomAreCountedAndTheTickGoesOn) {
  VirtualRobot robot(twoWheelsAndYaw());
  auto& trace = robot.exchange().trace;
  TraceChoice choice{.generation = 1, .count = 1, .signals = {}};
  choice.signals[0] = signal(0, "velocity_rpm");
  trace.choice.slot() = choice;
  trace.choice.publish();
  robot.run(static_cast<int>(TickTrace::kTicks) + 30);
  EXPECT_EQ(trace.dropped.load(), 30U);
}

// ---- The link thread's side

class TraceOnTheLink : public LinkRig {
 protected:
  /// The scheduler's part of a tick.
  void tick(std::uint64_t number) {
    snapshot_.tick = number;
    snapshot_.motors[0].target.value = static_cast<double>(number);
    snapshot_.motors[1].feedback.velocity_rpm = -static_cast<float>(number);
    trace(snapshot_, exchange.trace);
  }

 private:
  Snapshot snapshot_{};
};

TEST_F(TraceOnTheLink, AChoiceIsAnsweredWithWhatIsTraced) {
  auto client = join();
  client->send(choiceOf({signal(0, "target"), signal(1, "velocity_rpm")}));
  pump();
  const auto answer = client->take<link::Trace>();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->row_count, 0U);
  ASSERT_EQ(answer->signal_count, 2U);
  EXPECT_EQ(answer->signals[0], signal(0, "target"));
  EXPECT_EQ(answer->signals[1], signal(1, "velocity_rpm"));
}

TEST_F(TraceOnTheLink, EachTickArrivesOnceAndInOrder) {
  auto client = join();
  client->send(choiceOf({signal(0, "target"), signal(1, "velocity_rpm")}));
  pump();
  ASSERT_TRUE(client->take<link::Trace>());
  std::uint64_t sent = 100;
  std::int64_t expected = 100;
  for (int block = 0; block < 5; ++block) {
    for (int i = 0; i < 70; ++i) tick(sent++);
    while (expected < static_cast<std::int64_t>(sent)) {
      const auto rows = await<link::Trace>(*client);
      ASSERT_TRUE(rows);
      for (std::size_t i = 0; i < rows->row_count; ++i, ++expected) {
        EXPECT_EQ(rows->rows[i].tick, expected);
        EXPECT_EQ(rows->rows[i].values[0], static_cast<double>(expected));
        EXPECT_EQ(rows->rows[i].values[1], -static_cast<double>(expected));
      }
    }
  }
}

TEST_F(TraceOnTheLink, ClientsShareOneChoiceAndEachGetsTheRows) {
  auto first = join();
  auto second = join();
  first->send(choiceOf({signal(0, "target")}));
  second->send(choiceOf({signal(0, "target"), signal(1, "velocity_rpm")}));
  pump();
  const auto answer = second->take<link::Trace>();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->signal_count, 2U);
  ASSERT_TRUE(first->take<link::Trace>());
  tick(5);
  for (auto* client : {first.get(), second.get()}) {
    const auto rows = await<link::Trace>(*client);
    ASSERT_TRUE(rows);
    ASSERT_EQ(rows->row_count, 1U);
    EXPECT_EQ(rows->rows[0].values[0], 5.0);
  }
}

TEST_F(TraceOnTheLink, SignalsThatTheRobotDoesNotHaveAreLeftOut) {
  auto client = join();
  client->send(choiceOf({signal(9, "target"),
                         {link::TraceSource::kMotor, 0, 999},
                         {link::TraceSource::kModule, 0, 0},
                         {static_cast<link::TraceSource>(77), 0, 0},
                         signal(0, "torque_nm")}));
  pump();
  const auto answer = client->take<link::Trace>();
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->signal_count, 1U);
  EXPECT_EQ(answer->signals[0], signal(0, "torque_nm"));
}

TEST(TraceDesk, MoreThanThereIsRoomForIsLeftOutUntilThereIsRoom) {
  RobotDescription robot;
  robot.motors.resize(3);
  TickTrace trace;
  TraceDesk desk(robot, trace);
  link::TraceChoice all;
  for (std::uint16_t motor = 0; motor < 2; ++motor) {
    for (std::uint16_t value = 0; value < link::kTraceReadings.size(); ++value)
      all.signals[all.signal_count++] = {link::TraceSource::kMotor, motor, value};
  }
  ASSERT_EQ(all.signal_count, link::kMaxTraceSignals);
  desk.choose(1, all);
  desk.choose(2, choiceOf({signal(0, "target"), signal(2, "target")}));
  const auto traced = [&] {
    link::Trace answer;
    desk.fillChoice(answer);
    const auto end = answer.signals.begin() + answer.signal_count;
    return std::pair{answer.signal_count, std::find(answer.signals.begin(), end, signal(2, "target")) != end};
  };
  EXPECT_EQ(traced(), std::pair(32U, false));
  desk.forget(1);
  EXPECT_EQ(traced(), std::pair(2U, true));
}

TEST_F(TraceOnTheLink, WhenTheLastWatcherLeavesNothingIsTraced) {
  auto client = join();
  client->send(choiceOf({signal(0, "target")}));
  pump();
  client->leave();
  pump();
  tick(1);
  EXPECT_EQ(exchange.trace.ticks.read_available(), 0U);
}

TEST_F(TraceOnTheLink, AnEmptyChoiceEndsIt) {
  auto client = join();
  client->send(choiceOf({signal(0, "target")}));
  client->send(link::TraceChoice{});
  pump();
  tick(1);
  EXPECT_EQ(exchange.trace.ticks.read_available(), 0U);
}

TEST_F(TraceOnTheLink, RowsOfAnotherChoiceAreNeverMistakenForThisOne) {
  auto client = join();
  client->send(choiceOf({signal(0, "target")}));
  pump();
  tick(1);
  // The scheduler has not seen the new choice when it writes the next row.
  TracedTick old;
  ASSERT_TRUE(exchange.trace.ticks.pop(old));
  client->send(choiceOf({signal(1, "velocity_rpm")}));
  pump();
  while (client->take<link::Trace>()) {
  }
  ASSERT_TRUE(exchange.trace.ticks.push(old));
  tick(2);
  const auto rows = await<link::Trace>(*client);
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->row_count, 1U);
  EXPECT_EQ(rows->rows[0].tick, 2);
}

TEST_F(TraceOnTheLink, ACountBeyondTheRoomSendsTheClientAway) {
  auto client = join();
  link::TraceChoice choice;
  const auto sealed = link::seal(choice);
  choice.signal_count = link::kMaxTraceSignals + 1;
  client->sendBytes(sealed.data(), sealed.size());
  pump();
  EXPECT_TRUE(client->sentAway());
}

}  // namespace
}  // namespace rc10::test::tick_trace_test
