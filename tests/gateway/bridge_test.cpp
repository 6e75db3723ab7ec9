#include <chrono>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/message_limits.hpp"
#include "client/fake_rc10d.hpp"
#include "client/sample_messages.hpp"
#include "gateway/clock_sample.hpp"
#include "gateway/inlet.hpp"
#include "gateway/outlet.hpp"
#include "lcm_messages.hpp"
#include "rc10_version.hpp"

namespace rc10::gateway::test::bridge_test {
namespace {

using namespace std::chrono_literals;
using rc10::test::Bytes;
using rc10::test::commandWith;
using rc10::test::encoded;
using rc10::test::FakeRc10d;
using rc10::test::requestWith;
using testing::HasSubstr;

class RecordingPublisher : public LcmPublisher {
 public:
  void publish(std::string_view channel, std::span<const std::byte> message) noexcept override {
    sent[std::string(channel)].emplace_back(message.begin(), message.end());
  }
  std::map<std::string, std::vector<Bytes>> sent;
};

template <typename Message>
Message decoded(const Bytes& bytes) {
  Message message{};
  EXPECT_EQ(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return message;
}

class Bridge : public testing::Test {
 protected:
  Bridge() : client_(rc10d_.welcomed()), outlet_(client_.welcome(), lcm_), inlet_(client_, outlet_) {}

  bool arrive(const std::string& channel, const Bytes& message, Duration age = 0ns,
              UdpmDatagram::Kind kind = UdpmDatagram::Kind::kMessage) {
    return inlet_.handle({kind, channel, message}, now_ - age, now_);
  }
  template <typename Message>
  std::vector<Message> published(const std::string& channel) {
    std::vector<Message> messages;
    for (const auto& bytes : lcm_.sent[channel]) messages.push_back(decoded<Message>(bytes));
    return messages;
  }

  MonotonicTime now_{std::chrono::hours{1}};
  FakeRc10d rc10d_;
  LinkClient client_;
  RecordingPublisher lcm_;
  Outlet outlet_;
  Inlet inlet_;
};

TEST_F(Bridge, SubscribesToTheTwoChannelsOfItsRobotOnly) {
  EXPECT_EQ(inlet_.channels(), (std::vector<std::string>{"hero.v1.command", "hero.v1.request"}));
}

TEST_F(Bridge, PassesCommandsOnInOrderWithTheirReceiveTime) {
  for (int i = 1; i <= 3; ++i) {
    auto command = commandWith(i);
    command.seq = i;
    EXPECT_TRUE(arrive("hero.v1.command", encoded(command), 10ms * i));
  }
  for (int i = 1; i <= 3; ++i) {
    link::Command command;
    ASSERT_TRUE(rc10d_.receive(command));
    EXPECT_EQ(command.seq, i);
    EXPECT_EQ(command.setpoint_count, static_cast<std::uint32_t>(i));
    EXPECT_EQ(command.received_ns, (now_ - 10ms * i).time_since_epoch().count());
  }
  EXPECT_EQ(inlet_.counters().commands, 3U);
}

TEST_F(Bridge, PassesAnOldCommandOnSinceRc10dJudgesItsAge) {
  EXPECT_TRUE(arrive("hero.v1.command", encoded(commandWith(1)), 59min));
  link::Command command;
  ASSERT_TRUE(rc10d_.receive(command));
  EXPECT_EQ(command.received_ns, (now_ - 59min).time_since_epoch().count());
}

TEST_F(Bridge, PassesRequestsOnAndTheirResponsesBack) {
  EXPECT_TRUE(arrive("hero.v1.request", encoded(requestWith(1)), 5ms));
  link::Request request;
  ASSERT_TRUE(rc10d_.receive(request));
  EXPECT_EQ(request.operation.view(), "zero");
  EXPECT_EQ(request.received_ns, (now_ - 5ms).time_since_epoch().count());
  link::Response response;
  response.client = request.client;
  response.session = request.session;
  response.seq = request.seq;
  response.message = "zero: 2 of 2 motors";
  outlet_.forward(link::seal(response));
  const auto answers = published<response_t>("hero.v1.response");
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].client, "teleop");
  EXPECT_EQ(answers[0].session, 77);
  EXPECT_EQ(answers[0].seq, 5);
  EXPECT_EQ(answers[0].status, +response_t::STATUS_OK);
  EXPECT_EQ(answers[0].message, "zero: 2 of 2 motors");
}

TEST_F(Bridge, RefusesARequestThatWaitedTooLong) {
  auto enable = requestWith(0);
  enable.operation = "enable";
  EXPECT_TRUE(arrive("hero.v1.request", encoded(enable), 2s));
  EXPECT_TRUE(rc10d_.receiveBytes().empty());
  const auto answers = published<response_t>("hero.v1.response");
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].status, +response_t::STATUS_REFUSED);
  EXPECT_EQ(answers[0].seq, 5);
  EXPECT_THAT(answers[0].message, HasSubstr("2000 ms old"));
  EXPECT_EQ(inlet_.counters().stale_requests, 1U);
}

TEST_F(Bridge, PassesARequestOnThatIsAsOldAsItMayBe) {
  auto enable = requestWith(0);
  enable.operation = "enable";
  EXPECT_TRUE(arrive("hero.v1.request", encoded(enable), kMaxRequestAge));
  link::Request request;
  ASSERT_TRUE(rc10d_.receive(request));
  EXPECT_EQ(request.operation.view(), "enable");
  EXPECT_TRUE(arrive("hero.v1.request", encoded(enable), kMaxRequestAge + 1ns));
  EXPECT_TRUE(rc10d_.receiveBytes().empty());
}

TEST_F(Bridge, PassesOnWhatStopsMotorsHoweverLongItWaited) {
  for (const std::string operation : {"estop", "disable"}) {
    auto stop = requestWith(0);
    stop.operation = operation;
    EXPECT_TRUE(arrive("hero.v1.request", encoded(stop), 1h));
    link::Request request;
    ASSERT_TRUE(rc10d_.receive(request));
    EXPECT_EQ(request.operation.view(), operation);
  }
  EXPECT_EQ(inlet_.counters().stale_requests, 0U);
}

TEST_F(Bridge, SaysOfEachMessageWhetherThisComputerSentIt) {
  using link::Origin;
  const auto send = [&](const char* channel, const Bytes& bytes, Origin origin) {
    EXPECT_TRUE(inlet_.handle({UdpmDatagram::Kind::kMessage, channel, bytes}, now_, now_, origin));
  };
  for (const auto origin : {Origin::kThisComputer, Origin::kElsewhere, Origin::kThisComputer}) {
    send("hero.v1.command", encoded(commandWith(1)), origin);
    link::Command command;
    ASSERT_TRUE(rc10d_.receive(command));
    EXPECT_EQ(command.origin, origin);
    send("hero.v1.request", encoded(requestWith(1)), origin);
    link::Request request;
    ASSERT_TRUE(rc10d_.receive(request));
    EXPECT_EQ(request.origin, origin);
  }
  EXPECT_TRUE(arrive("hero.v1.command", encoded(commandWith(1)))) << "nothing is said of it";
  link::Command command;
  ASSERT_TRUE(rc10d_.receive(command));
  EXPECT_EQ(command.origin, Origin::kElsewhere);
}

TEST_F(Bridge, PassesAnOldStopOn) {
  for (const char* operation : {"estop", "disable"}) {
    auto stop = requestWith(0);
    stop.operation = operation;
    EXPECT_TRUE(arrive("hero.v1.request", encoded(stop), 59min));
    link::Request request;
    ASSERT_TRUE(rc10d_.receive(request));
    EXPECT_EQ(request.operation.view(), operation);
  }
}

TEST_F(Bridge, TellsAClientWithOtherDefinitionsOnceASecond) {
  auto bytes = encoded(commandWith(1));
  bytes[0] ^= std::byte{0xFF};
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(arrive("hero.v1.command", bytes));
  EXPECT_TRUE(rc10d_.receiveBytes().empty());
  auto events = published<event_t>("hero.v1.event");
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, 400);
  EXPECT_EQ(events[0].severity, +event_t::SEVERITY_ERROR);
  EXPECT_EQ(events[0].source, "lcm");
  EXPECT_EQ(events[0].mono_us, 3'600'000'000);
  EXPECT_EQ(events[0].text,
            "a client on channel hero.v1.command uses other definitions of command_t: regenerate its types "
            "from the "
            "lcm_types of rc10d " +
                std::string{kVersion})
      << "of rc10-lcm, which decodes, and not of the rc10d that it serves";
  now_ += 1s;
  arrive("hero.v1.command", bytes);
  events = published<event_t>("hero.v1.event");
  ASSERT_EQ(events.size(), 2U);
  EXPECT_THAT(events[1].text, HasSubstr("(9 more since the last report)"));
  EXPECT_EQ(inlet_.counters().defective, 11U);
}

TEST_F(Bridge, SaysWhatIsWrongWithAMessage) {
  auto bytes = encoded(commandWith(1));
  bytes.pop_back();
  arrive("hero.v1.command", bytes);
  auto request = requestWith(0);
  request.target.assign(2000, 'x');
  now_ += 2s;
  arrive("hero.v1.request", encoded(request));
  const auto events = published<event_t>("hero.v1.event");
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].code, 401);
  EXPECT_EQ(events[0].text, "a message on channel hero.v1.command is refused: it is truncated");
  EXPECT_EQ(events[1].text,
            "a message on channel hero.v1.request is refused: it has a name or text that is too long");
  // Its sender waits for an answer.
  const auto answers = published<response_t>("hero.v1.response");
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].status, +response_t::STATUS_REFUSED);
  EXPECT_EQ(answers[0].session, 77);
  EXPECT_TRUE(rc10d_.receiveBytes().empty());
}

TEST_F(Bridge, RefusesAMessageInSeveralDatagrams) {
  EXPECT_TRUE(arrive("hero.v1.command", {}, 0ns, UdpmDatagram::Kind::kFragment));
  ASSERT_EQ(published<event_t>("hero.v1.event").size(), 1U);
  EXPECT_THAT(published<event_t>("hero.v1.event")[0].text, HasSubstr("larger than any valid one"));
}

TEST_F(Bridge, IgnoresOtherChannels) {
  for (const char* channel : {"sentry.v1.command", "hero.v1.command.state", "hero.v1.state", ""}) {
    EXPECT_TRUE(arrive(channel, encoded(commandWith(1))));
  }
  EXPECT_TRUE(arrive("hero.v1.command", encoded(commandWith(1)), 0ns, UdpmDatagram::Kind::kForeign));
  EXPECT_TRUE(rc10d_.receiveBytes().empty());
  EXPECT_TRUE(lcm_.sent.empty());
}

TEST_F(Bridge, DropsCommandsThatRc10dDoesNotReadAndSaysSo) {
  const auto bytes = encoded(commandWith(100));
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(arrive("hero.v1.command", bytes));
  EXPECT_GT(inlet_.counters().busy, 0U);
  const auto events = published<event_t>("hero.v1.event");
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, 402);
}

TEST_F(Bridge, NoticesThatRc10dHasEnded) {
  rc10d_.end();
  EXPECT_FALSE(arrive("hero.v1.command", encoded(commandWith(1))));
}

TEST_F(Bridge, PublishesWhatRc10dSends) {
  auto state = rc10::test::heroState();
  auto diagnostics = rc10::test::heroDiagnostics();
  link::Event event;
  event.text = "ACTIVE -> READY";
  outlet_.forward(link::seal(state));
  outlet_.forward(link::seal(diagnostics));
  outlet_.forward(link::seal(event));
  ASSERT_EQ(published<robot_state_t>("hero.v1.state").size(), 1U);
  EXPECT_EQ(published<robot_state_t>("hero.v1.state")[0].motors[1].name, "yaw");
  EXPECT_EQ(published<diagnostics_t>("hero.v1.diagnostics")[0].missed_ticks, 2);
  EXPECT_EQ(published<event_t>("hero.v1.event")[0].text, "ACTIVE -> READY");
}

TEST_F(Bridge, CountsWhatItDoesNotUnderstandOfRc10d) {
  link::Hello hello;
  outlet_.forward(link::seal(hello));
  outlet_.forward({});
  outlet_.forward(Bytes(100));
  EXPECT_EQ(outlet_.malformed(), 3U);
  EXPECT_TRUE(lcm_.sent.empty());
}

TEST(Throttle, LetsOneReportASecondPass) {
  Throttle throttle;
  const MonotonicTime start{};
  EXPECT_EQ(throttle.pass(start), 0U);
  EXPECT_FALSE(throttle.pass(start + 1ms));
  EXPECT_FALSE(throttle.pass(start + 999ms));
  EXPECT_EQ(throttle.pass(start + 1s), 2U);
  EXPECT_FALSE(throttle.pass(start + 1999ms));
  EXPECT_EQ(throttle.pass(start + 5s), 1U);
}

TEST(ClockSample, ReadsBothClocksTogether) {
  const auto before = std::chrono::steady_clock::now();
  const auto sample = sampleClocks();
  EXPECT_GE(sample.now, before);
  EXPECT_LE(sample.now, std::chrono::steady_clock::now());
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const auto expected = wall - std::chrono::steady_clock::now().time_since_epoch();
  EXPECT_LT(std::chrono::abs(expected - sample.realtime_offset), 1s);
}

TEST(WakeUp, JudgesByTheLastTimeTheSocketWasEmpty) {
  const ClockSample empty{MonotonicTime{10s}, 1000s};
  const ClockSample now{MonotonicTime{12s}, 1000s};
  const auto wake = wakeUp(now, empty);
  EXPECT_EQ(toMonotonic(1011s, wake), MonotonicTime{11s});
  EXPECT_EQ(toMonotonic(1013s, wake), MonotonicTime{12s}) << "not in the future";
  EXPECT_EQ(toMonotonic(1001s, wake), MonotonicTime{10s}) << "not before the socket was empty";
  // The wall clock was stepped meanwhile: the oldest possible time.
  EXPECT_EQ(toMonotonic(1012s, wakeUp({MonotonicTime{12s}, 1001s}, empty)), MonotonicTime{10s});
}

}  // namespace
}  // namespace rc10::gateway::test::bridge_test
