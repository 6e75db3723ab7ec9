#include "daemon/clients/link_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <span>

#include "daemon/exchange/clock.hpp"
#include "daemon/link_rig.hpp"
#include "daemon/virtual_robot.hpp"
#include "link/until_its_end.hpp"

namespace rc10::test::link_server_test {
namespace {

using ::testing::HasSubstr;

class LinkServerTest : public LinkRig {
 protected:
  void sendFiveToNobody(TestClient& client) {
    for (int i = 1; i <= 5; ++i) {
      auto unknown = velocityCommand(i);
      unknown.setpoints[0].motor = "nobody";
      EXPECT_TRUE(client.send(unknown));
    }
    pump();
  }
};

TEST_F(LinkServerTest, AHelloIsAnsweredWithWhatTheRobotIs) {
  TestClient client(path);
  ASSERT_TRUE(client.send(link::Hello{}));
  pump();
  const auto welcome = client.take<link::Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->protocol_version, link::kProtocolVersion);
  EXPECT_EQ(welcome->pid, ::getpid());
  EXPECT_EQ(welcome->robot.view(), "hero");
  ASSERT_EQ(welcome->motor_count, 2U);
  EXPECT_EQ(welcome->motors[1].name.view(), "right");
  EXPECT_FALSE(client.sentAway());
}

TEST_F(LinkServerTest, AClientOfAnotherProtocolVersionIsToldOursAndSentAway) {
  TestClient client(path);
  link::Hello hello;
  hello.protocol_version = link::kProtocolVersion + 1;
  ASSERT_TRUE(client.send(hello));
  pump();
  const auto welcome = client.take<link::Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->protocol_version, link::kProtocolVersion);
  EXPECT_TRUE(client.sentAway());
}

TEST_F(LinkServerTest, ACommandBeforeTheHelloDoesNotReachTheScheduler) {
  TestClient client(path);
  ASSERT_TRUE(client.send(velocityCommand(1)));
  pump();
  EXPECT_TRUE(client.sentAway());
  EXPECT_EQ(exchange.commands.read_available(), 0U);
}

TEST_F(LinkServerTest, ACommandReachesTheScheduler) {
  auto client = join();
  const auto before = monotonicNow();
  ASSERT_TRUE(client->send(velocityCommand(1)));
  pump();
  Command command;
  ASSERT_TRUE(exchange.commands.pop(command));
  ASSERT_EQ(command.count, 1U);
  EXPECT_EQ(command.setpoints[0].motor, 0U);
  EXPECT_EQ(command.setpoints[0].target.value, 120.0);
  EXPECT_EQ(command.client.view(), "planner");
  EXPECT_GE(command.deadline, before + kDefaultValidity);
  EXPECT_LE(command.deadline, monotonicNow() + kDefaultValidity);
}

TEST_F(LinkServerTest, ACommandThatIsLateReachesTheSchedulerOnceToEndWhatWasBeforeIt) {
  auto client = join();
  ASSERT_TRUE(client->send(velocityCommand(1)));
  auto late = velocityCommand(2);
  late.received_ns = 1;
  ASSERT_TRUE(client->send(late));
  ASSERT_TRUE(client->send(late));
  pump();
  Command command;
  ASSERT_TRUE(exchange.commands.pop(command));
  ASSERT_TRUE(exchange.commands.pop(command));
  EXPECT_LT(command.deadline, monotonicNow());
  EXPECT_EQ(command.setpoints[0].motor, 0U);
  EXPECT_FALSE(exchange.commands.pop(command));
}

TEST_F(LinkServerTest, RefusedCommandsAreCountedByReason) {
  auto client = join(link::kDiagnosticsFeed);
  auto unknown = velocityCommand(1);
  unknown.setpoints[0].motor = "nobody";
  ASSERT_TRUE(client->send(unknown));
  for (int i = 0; i < 66; ++i) {  // the ring has room for 64
    ASSERT_TRUE(client->send(velocityCommand(i + 1)));
    pump();
  }
  const auto diagnostics = await<link::Diagnostics>(*client);
  ASSERT_TRUE(diagnostics);
  const auto count = [&](std::string_view name) -> std::int64_t {
    for (std::size_t i = 0; i < diagnostics->refusal_count; ++i) {
      if (diagnostics->refusals[i].name.view() == name) return diagnostics->refusals[i].count;
    }
    return -1;
  };
  EXPECT_EQ(count("unknown motor"), 1);
  EXPECT_EQ(count("too many commands"), 2);
  EXPECT_EQ(count("old sequence"), 0);
}

TEST_F(LinkServerTest, ACommandWhoseCountDoesNotFitIsCountedAndTheClientStays) {
  auto client = join(link::kDiagnosticsFeed);
  auto command = velocityCommand(1);
  const auto bytes = link::seal(command);
  command.setpoint_count = 2;  // but only one travels
  ASSERT_TRUE(client->sendBytes(bytes.data(), bytes.size()));
  pump();
  EXPECT_FALSE(client->sentAway());
  EXPECT_EQ(exchange.commands.read_available(), 0U);
  const auto diagnostics = await<link::Diagnostics>(*client);
  ASSERT_TRUE(diagnostics);
  EXPECT_EQ(diagnostics->refusals[0].name.view(), "malformed");
  EXPECT_EQ(diagnostics->refusals[0].count, 1);
}

TEST_F(LinkServerTest, ARequestIsAnsweredWhenTheSchedulerHasDoneItAndOnlyToTheOneWhoAsked) {
  auto client = join();
  auto other = join();
  ASSERT_TRUE(client->send(linkRequest(5, "enable", "right")));
  pump();
  const auto order = takeOrder();
  EXPECT_EQ(order.operation, Operation::kEnable);
  EXPECT_EQ(order.motors, MotorSet{0b10});
  EXPECT_FALSE(client->take<link::Response>());
  finish(order);
  const auto response = await<link::Response>(*client);
  ASSERT_TRUE(response);
  EXPECT_EQ(response->seq, 5);
  EXPECT_EQ(response->status, link::ResponseStatus::kOk);
  EXPECT_FALSE(other->take<link::Response>());
}

TEST_F(LinkServerTest, AStateComesAfterTheEventsOfItsTicks) {
  auto client = join(link::kStates | link::kEvents);
  for (std::uint64_t tick = 1; tick <= 20; ++tick) {
    ASSERT_TRUE(exchange.events.push({EventCode::kMotorStatus, Severity::kInfo, 0, 1, 2, monotonicNow()}));
    publishSnapshot(tick);
    std::optional<link::State> state;
    do state = await<link::State>(*client);
    while (state && state->tick < static_cast<std::int64_t>(tick));
    ASSERT_TRUE(state);
    EXPECT_EQ(logged.size(), tick) << "an event is logged when it is sent";
  }
}

TEST_F(LinkServerTest, ARefusedRequestIsAnsweredAtOnce) {
  auto client = join();
  ASSERT_TRUE(client->send(linkRequest(5, "dance")));
  pump();
  const auto response = client->take<link::Response>();
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kRefused);
  EXPECT_EQ(exchange.orders.read_available(), 0U);
  EXPECT_FALSE(exchange.estop.load());
}

TEST_F(LinkServerTest, OfRequestsFromBeforeAPauseOnlyThoseThatStopAreDone) {
  auto client = join();
  std::int64_t seq = 0;
  for (const auto* operation : {"clear", "enable", "disable", "estop"}) {
    auto request = linkRequest(++seq, operation);
    request.received_ns = 1;
    ASSERT_TRUE(client->send(request));
  }
  pump();
  EXPECT_EQ(takeOrder().operation, Operation::kDisable);
  EXPECT_EQ(takeOrder().operation, Operation::kEstop);
  EXPECT_EQ(exchange.orders.read_available(), 0U);
  EXPECT_TRUE(exchange.estop.load());
  for (int i = 0; i < 2; ++i) {
    const auto response = client->take<link::Response>();
    ASSERT_TRUE(response);
    EXPECT_EQ(response->status, link::ResponseStatus::kRefused);
    EXPECT_THAT(std::string(response->message.view()), HasSubstr("it was not done; ask again"));
  }
}

TEST_F(LinkServerTest, AnEstopRaisesTheFlagEvenWhenTheSchedulerTakesNoOrders) {
  auto client = join();
  while (exchange.orders.push(Order{})) {
  }
  ASSERT_TRUE(client->send(linkRequest(6, "estop")));
  pump();
  EXPECT_TRUE(exchange.estop.load());
  const auto response = client->take<link::Response>();
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kFailed);
  EXPECT_THAT(std::string(response->message.view()), HasSubstr("does not take orders"));
}

TEST_F(LinkServerTest, AnEstopForAnUnknownMotorRaisesTheFlag) {
  auto client = join();
  ASSERT_TRUE(client->send(linkRequest(6, "estop", "nobody")));
  pump();
  EXPECT_TRUE(exchange.estop.load());
}

TEST_F(LinkServerTest, StatesGoToTheSubscribersOnly) {
  auto client = join(link::kStates);
  auto other = join();
  publishSnapshot(4711);
  const auto state = await<link::State>(*client);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->motor_count, 2U);
  // Any number of older ones may have left before it.
  auto newest = state;
  while (newest && newest->tick != 4711) newest = await<link::State>(*client);
  EXPECT_TRUE(newest);
  EXPECT_FALSE(other->take<link::State>());
}

TEST_F(LinkServerTest, ThereIsNoStateBeforeTheFirstTick) {
  auto client = join(link::kStates | link::kDiagnosticsFeed);
  ASSERT_TRUE(await<link::Diagnostics>(*client));  // several periods of the states
  EXPECT_FALSE(client->take<link::State>());
}

TEST_F(LinkServerTest, TheAgeOfTheFeedbackInEachStateIsTold) {
  auto& slot = exchange.snapshot.slot();
  for (std::size_t i = 0; i < 2; ++i) {
    slot.motors[i].status = i == 0 ? MotorStatus::kReady : MotorStatus::kOffline;
    slot.motors[i].feedback.samples = 1;
    slot.motors[i].feedback.received = monotonicNow() - std::chrono::seconds{i == 0 ? 5 : 500};
  }
  publishSnapshot(1);
  auto client = join(link::kStates | link::kDiagnosticsFeed);
  ASSERT_TRUE(await<link::State>(*client));
  const auto diagnostics = await<link::Diagnostics>(*client);
  ASSERT_TRUE(diagnostics);
  const auto named = std::span{diagnostics->durations}.first(diagnostics->duration_count);
  const auto age = std::find_if(named.begin(), named.end(), [](const link::Durations& each) {
    return each.name.view() == "feedback to clients";
  });
  ASSERT_NE(age, named.end());
  EXPECT_GE(age->count, 1);
  EXPECT_GE(age->percentiles.p50_us, 5e6);
  EXPECT_LT(age->percentiles.max_us, 400e6) << "not that of a motor that is OFFLINE";
}

TEST_F(LinkServerTest, DiagnosticsGoToTheSubscribersOnly) {
  auto client = join(link::kDiagnosticsFeed);
  auto other = join(link::kStates);
  publishSnapshot(1);
  const auto diagnostics = await<link::Diagnostics>(*client);
  ASSERT_TRUE(diagnostics);
  EXPECT_EQ(diagnostics->page_faults, 17);
  EXPECT_FALSE(other->take<link::Diagnostics>());
}

TEST_F(LinkServerTest, EventsGoToTheSubscribersAndAllOfThemToTheLog) {
  auto client = join(link::kEvents);
  auto other = join(link::kStates);
  exchange.events.push({EventCode::kTicksMissed, Severity::kWarning, -1, 12, 0, {}});
  const auto event = await<link::Event>(*client);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->source.view(), "robot");
  EXPECT_EQ(event->text.view(), "12 ticks missed");
  EXPECT_FALSE(other->take<link::Event>());
  ASSERT_EQ(logged.size(), 1U);
  EXPECT_EQ(logged[0].text.view(), "12 ticks missed");
}

TEST_F(LinkServerTest, NotesOfTheIoThreadAreEventsToo) {
  auto client = join(link::kEvents);
  link::Event note;
  note.code = 301;
  note.text = "can0 is down";
  exchange.notes.push(note);
  const auto event = await<link::Event>(*client);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->code, 301);
  EXPECT_EQ(event->text.view(), "can0 is down");
  ASSERT_EQ(logged.size(), 1U);
}

TEST_F(LinkServerTest, ARefusedCommandIsToldInWordsButNotEveryTime) {
  auto client = join(link::kEvents);
  sendFiveToNobody(*client);
  const auto event = client->take<link::Event>();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->code, static_cast<std::int32_t>(EventCode::kCommandRefused));
  EXPECT_EQ(event->text.view(),
            "command of 'planner' refused: nobody: unknown motor; `rc10ctl watch` shows the names");
  EXPECT_FALSE(client->take<link::Event>());
  ASSERT_EQ(logged.size(), 1U);
}

TEST_F(LinkServerTest, ARefusedCommandGoesIntoTheBlackBoxAsItIsTold) {
  auto client = join(link::kEvents);
  sendFiveToNobody(*client);
  Event event;
  ASSERT_TRUE(exchange.refusals.pop(event));
  EXPECT_EQ(event.code, EventCode::kCommandRefused);
  EXPECT_EQ(event.value, static_cast<std::int32_t>(CommandRefusal::kUnknownMotor));
  EXPECT_EQ(event.client.view(), "planner");
  EXPECT_FALSE(exchange.refusals.pop(event)) << "once a second";
}

TEST_F(LinkServerTest, TriedGainsThatCannotBeSetBackAreInTheLogOnceAndInTheDiagnostics) {
  const auto tuned = twoWheelsAndYaw().buses[0].motors[0];
  robot.motors[0].loops = {tuned.settings.model, tuned.traits(), tuned.settings.loops};
  serve();
  auto client = join();
  auto request = linkRequest(1, toString(Operation::kSetGains), "left");
  request.value_count = 2;
  request.values[0] = {.name = std::string_view{"velocity.kp"}, .value = 0.5};
  request.values[1] = {.name = link::kRestoreAtEnd, .value = 1.0};
  ASSERT_TRUE(client->send(request));
  pump();
  finish(takeOrder());
  ASSERT_TRUE(await<link::Response>(*client));
  client->leave();
  auto other = join(link::kDiagnosticsFeed);
  Order order;
  int tries = 0;
  for (int i = 0; i < 3000 && logged.empty(); ++i) {
    server->poll(100);
    if (!exchange.orders.pop(order)) continue;
    ++tries;
    OrderResult refused{.id = order.id};
    refused.motors[0] = Refusal::kNoGains;
    EXPECT_TRUE(exchange.results.push(refused));
  }
  EXPECT_EQ(tries, 3);
  ASSERT_EQ(logged.size(), 1U);
  EXPECT_THAT(std::string(logged[0].text.view()), HasSubstr("velocity_pid.kp_a_per_rpm is 0.5, not "));
  while (other->take<link::Diagnostics>()) {
  }
  const auto diagnostics = await<link::Diagnostics>(*other);
  ASSERT_TRUE(diagnostics);
  ASSERT_EQ(diagnostics->notice_count, 1U);
  EXPECT_EQ(diagnostics->notices[0].view(), logged[0].text.view());
  EXPECT_FALSE(exchange.orders.pop(order)) << "no further try";
}

TEST_F(LinkServerTest, EventsAreLoggedWhenNobodyListens) {
  exchange.events.push({EventCode::kTicksMissed, Severity::kWarning, -1, 12, 0, {}});
  for (int i = 0; i < 3000 && logged.empty(); ++i) server->poll(100);
  EXPECT_EQ(logged.size(), 1U);
}

TEST_F(LinkServerTest, FiveHousekeepingsFallOnOneDiagnostics) {
  auto client = join(link::kDiagnosticsFeed);
  ASSERT_TRUE(await<link::Diagnostics>(*client));
  const int at_first = housekeeping;
  ASSERT_TRUE(await<link::Diagnostics>(*client));
  EXPECT_EQ(housekeeping - at_first, 5);
}

TEST_F(LinkServerTest, TheLastEventsAndAnswersLeaveWhenTheThreadEnds) {
  auto client = join(link::kEvents);
  ASSERT_TRUE(client->send(linkRequest(1, "disable")));
  pump();
  const auto order = takeOrder();
  std::stop_source stop;
  stop.request_stop();
  finish(order);
  exchange.events.push({EventCode::kRobotState, Severity::kInfo, -1, 2, 0, {}});
  server->run(stop.get_token());
  EXPECT_TRUE(client->take<link::Response>());
  EXPECT_TRUE(client->take<link::Event>());
}

}  // namespace
}  // namespace rc10::test::link_server_test
