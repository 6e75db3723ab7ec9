#include "daemon/clients/scan_desk.hpp"

#include <gmock/gmock.h>

#include <string>

#include "bus/frame_text.hpp"
#include "config/motor_families.hpp"
#include "daemon/link_messages.hpp"
#include "daemon/link_rig.hpp"
#include "survey/harmless_queries.hpp"

namespace rc10::test::scan_desk_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kLeft = "201#0123004520121900";
constexpr const char* kStranger = "203#0123004520121900";

/// The scheduler's part is played by the test.
class ScanServerTest : public LinkRig {
 protected:
  ScanServerTest() {
    for (std::size_t i = 0; i < robot.motors.size(); ++i) {
      auto& motor = robot.motors[i];
      motor.family = findFamily("M3508")->family;
      motor.sends = {FrameFilter{.id = {0x201U + static_cast<std::uint32_t>(i), false}}};
      motor.steers = {FrameFilter{.id = {0x200, false}}};
    }
  }

  Order ask(TestClient& client, std::int64_t seq = 1) {
    EXPECT_TRUE(client.send(linkRequest(seq, "scan", "chassis")));
    pump();
    return takeOrder();
  }
  void hear(const char* frame) {
    EXPECT_TRUE(exchange.scan.heard.push(parseFrameText(frame).value_or(CanFrame{})));
  }
  void handOver(const Order& order) {
    exchange.scan.listened.store(order.id);
    for (int i = 0; i < 3000 && exchange.scan.ready.load() != order.id; ++i) server->poll(100);
    EXPECT_EQ(exchange.scan.ready.load(), order.id);
  }
};

TEST_F(ScanServerTest, AScanIsAnOrderForItsBus) {
  auto client = join();
  const auto order = ask(*client);
  EXPECT_EQ(order.operation, Operation::kScan);
  EXPECT_EQ(order.scan.bus, 0U);
  EXPECT_EQ(order.motors, MotorSet{0b11});
  EXPECT_FALSE(client->take<link::Response>());
}

TEST_F(ScanServerTest, AllQuestionsAreHandedOverWhenTheListeningIsOver) {
  auto client = join();
  const auto order = ask(*client);
  hear(kLeft);
  pump();
  EXPECT_NE(exchange.scan.ready.load(), order.id);
  handOver(order);
  EXPECT_EQ(exchange.scan.question_count, survey::harmlessQueries().size());
  EXPECT_LE(survey::harmlessQueries().size(), BusScanExchange::kMostQuestions);
}

TEST_F(ScanServerTest, AQuestionThatIsACommandToADriveThatWasHeardIsLeftOut) {
  auto client = join();
  const auto order = ask(*client);
  hear("00001101#0000000001000000");  // the heartbeat of an ODrive with extended ids, node 136
  handOver(order);
  EXPECT_EQ(exchange.scan.question_count, survey::harmlessQueries().size() - 32);
  finish(order);
  EXPECT_THAT(std::string{await<link::Response>(*client)->message.view()},
              HasSubstr("an ODrive with extended ids, node 136, would take the questions for commands"));
}

TEST_F(ScanServerTest, AQuestionThatIsACommandToAMotorOfTheFileIsLeftOutThoughItIsSilent) {
  robot.motors[1].steers = {FrameFilter{.id = survey::harmlessQueries().front().id}};
  auto client = join();
  const auto order = ask(*client);
  handOver(order);
  EXPECT_EQ(exchange.scan.question_count, survey::harmlessQueries().size() - 1);
  finish(order);
  EXPECT_THAT(std::string{await<link::Response>(*client)->message.view()}, HasSubstr("motor 'right'"));
}

TEST_F(ScanServerTest, SightingsComeBeforeTheAnswerWithTheirMotors) {
  auto client = join();
  const auto order = ask(*client);
  hear(kLeft);
  hear(kStranger);
  handOver(order);
  finish(order);
  const auto first = await<link::Sighting>(*client);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->seq, 1);
  EXPECT_EQ(first->client.view(), "pilot");
  EXPECT_EQ(first->guesses[0].motor.view(), "left");
  const auto second = client->take<link::Sighting>();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->frame_id, 0x203U);
  EXPECT_EQ(second->guesses[0].motor.view(), "");
  const auto response = await<link::Response>(*client);
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kOk);
  EXPECT_THAT(
      std::string{response->message.view()},
      AllOf(StartsWith("scan: chassis: DJI M3508 or M2006 id 1 (left), DJI M3508 or M2006 id 3 (not in "
                       "the file)\n"),
            HasSubstr("\nnot heard, but in the file: right\n")));
}

TEST_F(ScanServerTest, ErrorFramesMeanwhileAreAHintAtTheBitRate) {
  auto client = join();
  const auto order = ask(*client);
  handOver(order);
  OrderResult result;
  result.id = order.id;
  result.error_frames = 12;
  ASSERT_TRUE(exchange.results.push(result));
  EXPECT_THAT(std::string{await<link::Response>(*client)->message.view()},
              HasSubstr("12 error frames meanwhile: a drive with another bit rate"));
}

TEST_F(ScanServerTest, ARefusalNamesEachMotorAndItsRemedyAndTellsNoSighting) {
  auto client = join();
  const auto order = ask(*client);
  hear(kLeft);
  OrderResult result;
  result.id = order.id;
  result.refused = true;
  result.motors[0] = Refusal::kActive;
  result.motors[1] = Refusal::kFaulted;
  ASSERT_TRUE(exchange.results.push(result));
  const auto response = await<link::Response>(*client);
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kRefused);
  EXPECT_EQ(
      response->message.view(),
      "scan: chassis is scanned only while its motors rest: left: ENABLING or ACTIVE: disable it first; "
      "right: in FAULT: clear it first");
}

TEST_F(ScanServerTest, AnEndBeforeItsTimeFailsWithItsReason) {
  auto client = join();
  const auto order = ask(*client);
  OrderResult result;
  result.id = order.id;
  result.motors[0] = Refusal::kActive;
  ASSERT_TRUE(exchange.results.push(result));
  const auto response = await<link::Response>(*client);
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kFailed);
  EXPECT_THAT(std::string{response->message.view()},
              HasSubstr("was not scanned to the end: left: enabled meanwhile"));
}

TEST_F(ScanServerTest, OneScanGoesOnAtATimeAndTheNextBeginsWithNothing) {
  auto client = join();
  auto other = join(0, "other");
  const auto first = ask(*client);
  hear(kStranger);
  auto second = linkRequest(7, "scan", "chassis");
  second.client = "other";
  ASSERT_TRUE(other->send(second));
  const auto refused = await<link::Response>(*other);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status, link::ResponseStatus::kFailed);
  EXPECT_THAT(std::string{refused->message.view()}, HasSubstr("another scan goes on"));
  OrderResult ended;
  ended.id = first.id;
  ended.scan = Refusal::kBusHeld;
  ASSERT_TRUE(exchange.results.push(ended));
  ASSERT_TRUE(await<link::Response>(*client));
  hear(kStranger);  // by a tick of the first
  const auto third = ask(*client, 2);
  handOver(third);
  finish(third);
  EXPECT_THAT(std::string{await<link::Response>(*client)->message.view()},
              StartsWith("scan: chassis: no drive was heard"));
}

TEST_F(ScanServerTest, AScanWhoseClientIsGoneIsGivenUpAndOneThatIsAskedForAgainIsNot) {
  auto client = join();
  const auto order = ask(*client);
  pump();
  EXPECT_NE(exchange.scan.given_up.load(), order.id);
  client->leave();
  for (int i = 0; i < 3000 && exchange.scan.given_up.load() != order.id; ++i) server->poll(100);
  EXPECT_EQ(exchange.scan.given_up.load(), order.id);
  OrderResult ended;
  ended.id = order.id;
  ended.scan = Refusal::kClientGone;
  ASSERT_TRUE(exchange.results.push(ended));
  for (int i = 0; i < 3000 && exchange.results.read_available() > 0; ++i) server->poll(100);
  auto other = join(0, "other");
  const auto next = ask(*other, 9);
  EXPECT_NE(next.id, order.id);
  handOver(next);
  EXPECT_EQ(exchange.scan.given_up.load(), order.id);
}

TEST_F(ScanServerTest, AClientThatLeavesKeepsNobodyFromScanning) {
  auto client = join();
  const auto order = ask(*client);
  hear(kLeft);
  handOver(order);
  client->leave();
  finish(order);
  for (int i = 0; i < 3000 && exchange.results.read_available() > 0; ++i) server->poll(100);
  auto other = join(0, "pilot");
  const auto next = ask(*other, 9);
  EXPECT_EQ(next.operation, Operation::kScan);
}

}  // namespace
}  // namespace rc10::test::scan_desk_test
