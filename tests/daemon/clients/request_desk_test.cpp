#include "daemon/clients/request_desk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/described_robot.hpp"
#include "daemon/link_messages.hpp"
#include "link/at_end.hpp"

namespace rc10::test::request_desk_test {
namespace {

using namespace std::chrono_literals;
using link::ResponseStatus;
using ::testing::HasSubstr;

constexpr std::uint64_t kConnection = 3;

class RequestDeskTest : public ::testing::Test {
 protected:
  RequestDesk::Outcome begin(const link::Request& request) {
    return desk.begin(request, {.connection = kConnection}, kAnyTime);
  }
  /// The text of a refusal.
  std::string refusal(const link::Request& request) {
    const auto outcome = begin(request);
    EXPECT_FALSE(outcome.order);
    if (!outcome.response) return "no response";
    EXPECT_EQ(outcome.response->status, ResponseStatus::kRefused);
    EXPECT_EQ(outcome.response->seq, request.seq);
    return std::string(outcome.response->message.view());
  }
  /// The supervisor's result when every motor has done it.
  static OrderResult done(const Order& order) {
    OrderResult result;
    result.id = order.id;
    return result;
  }
  static link::Request zero(std::int64_t seq, std::string_view target, double angle_deg) {
    auto request = linkRequest(seq, "zero", target);
    request.value_count = 1;
    request.values[0] = {.name = std::string_view{"angle_deg"}, .value = angle_deg};
    return request;
  }

  RobotDescription robot = describedRobot({"left", "right", "yaw"});
  Admission admission{robot};
  RequestDesk desk{admission, robot};
};

TEST_F(RequestDeskTest, EveryOperationBecomesItsOrder) {
  constexpr std::array<std::pair<const char*, Operation>, 6> kOperations{
      {{"enable", Operation::kEnable},
       {"enable_alone", Operation::kEnableAlone},
       {"disable", Operation::kDisable},
       {"estop", Operation::kEstop},
       {"clear", Operation::kClear},
       {"zero", Operation::kZero}}};
  std::int64_t seq = 0;
  for (const auto& [word, operation] : kOperations) {
    const auto outcome = begin(linkRequest(++seq, word, "right"));
    ASSERT_TRUE(outcome.order) << word;
    EXPECT_EQ(outcome.order->operation, operation);
    EXPECT_EQ(outcome.order->motors, MotorSet{0b010});
    EXPECT_FALSE(outcome.response) << "answered when the supervisor has done it";
    EXPECT_EQ(outcome.estop, operation == Operation::kEstop);
  }
}

TEST_F(RequestDeskTest, NoTargetMeansEveryMotor) {
  EXPECT_EQ(begin(linkRequest(1, "enable")).order->motors, MotorSet{0b111});
}

TEST_F(RequestDeskTest, OnlyARequestThatNamesNoMotorIsOfTheWholeRobot) {
  EXPECT_TRUE(begin(linkRequest(1, "clear")).order->whole_robot);
  EXPECT_FALSE(begin(linkRequest(2, "clear", "left,right,yaw")).order->whole_robot);
}

TEST(RequestDeskOfOneMotor, AClearThatNamesItIsNotOfTheWholeRobot) {
  RobotDescription robot = describedRobot({"wheel"});
  Admission admission{robot};
  RequestDesk desk{admission, robot};
  EXPECT_FALSE(
      desk.begin(linkRequest(1, "clear", "wheel"), {.connection = kConnection}, kAnyTime).order->whole_robot);
  EXPECT_TRUE(desk.begin(linkRequest(2, "clear"), {.connection = kConnection}, kAnyTime).order->whole_robot);
}

TEST_F(RequestDeskTest, SeveralMotorsAreSeparatedByCommas) {
  EXPECT_EQ(begin(linkRequest(1, "enable", "yaw,left")).order->motors, MotorSet{0b101});
}

TEST_F(RequestDeskTest, OrdersHaveDifferentIds) {
  const auto first = begin(linkRequest(1, "enable"));
  const auto second = begin(linkRequest(2, "enable"));
  EXPECT_NE(first.order->id, second.order->id);
}

TEST_F(RequestDeskTest, ZeroCarriesItsAngle) {
  EXPECT_EQ(begin(zero(1, "left", 90.0)).order->value, 90.0);
  EXPECT_EQ(begin(linkRequest(2, "zero", "left")).order->value, 0.0);
}

TEST_F(RequestDeskTest, ZeroWithAMisspeltAngleIsNoZeroAt0) {
  auto request = zero(1, "left", 90.0);
  request.values[0].name = "angel_deg";
  EXPECT_THAT(refusal(request),
              HasSubstr("there is no value 'angel_deg': it takes angle_deg; did you mean angle_deg?"));
}

TEST_F(RequestDeskTest, ZeroNeedsAMotor) {
  EXPECT_THAT(refusal(linkRequest(1, "zero")), HasSubstr("name it"));
}

TEST_F(RequestDeskTest, AClearOfMotorsSaysThatTheEstopStays) {
  const auto outcome = begin(linkRequest(1, "clear", "left"));
  auto result = done(*outcome.order);
  result.estop_stays = true;
  EXPECT_EQ(desk.finish(result)->response.message.view(),
            "clear: 1 of 1 motors; the e-stop stays: `clear` without a name ends it");
}

TEST_F(RequestDeskTest, AnAbsoluteEncodersZeroIsAnsweredWithTheLineThatKeepsIt) {
  const auto outcome = begin(zero(1, "left", 90.0));
  auto result = done(*outcome.order);
  result.zero_deg = -70.004;
  const auto response = desk.finish(result)->response;
  EXPECT_EQ(response.message.view(), "zero: 1 of 1 motors; zero_deg: -70 in the file keeps it");
  ASSERT_EQ(response.value_count, 1U);
  EXPECT_EQ(response.values[0].name.view(), "zero_deg");
  EXPECT_EQ(response.values[0].value, -70.0);
}

TEST_F(RequestDeskTest, ACountingEncodersZeroIsAnsweredWithoutALine) {
  const auto outcome = begin(zero(1, "left", 90.0));
  const auto response = desk.finish(done(*outcome.order))->response;
  EXPECT_EQ(response.message.view(), "zero: 1 of 1 motors");
  EXPECT_EQ(response.value_count, 0U);
}

TEST_F(RequestDeskTest, OnlyOneMotorIsEnabledAlone) {
  EXPECT_THAT(refusal(linkRequest(1, "enable_alone")), HasSubstr("name one motor"));
  EXPECT_THAT(refusal(linkRequest(2, "enable_alone", "left,right")), HasSubstr("name one motor"));
}

TEST_F(RequestDeskTest, WhoeverIsInTheWayOfAnEnablingIsNamedWithTheWayOut) {
  const auto alone = begin(linkRequest(1, "enable_alone", "left"));
  auto result = done(*alone.order);
  result.motors[0] = Refusal::kOthersOn;
  result.in_the_way = MotorSet{0b110};
  EXPECT_EQ(desk.finish(result)->response.message.view(),
            "enable_alone: 0 of 1 motors (left: not the only one: `rc10ctl disable right yaw` first)");
  const auto every = begin(linkRequest(2, "enable"));
  result = done(*every.order);
  result.motors[0] = result.motors[2] = Refusal::kAlone;
  result.in_the_way = MotorSet{0b010};
  EXPECT_EQ(desk.finish(result)->response.message.view(),
            "enable: 1 of 3 motors (left, yaw: locked while right is enabled alone: `rc10ctl disable right` "
            "ends that)");
}

TEST_F(RequestDeskTest, RefusesAZeroFartherThanSoftLimitsGo) {
  EXPECT_EQ(begin(zero(1, "left", -1e6)).order->value, -1e6);
  EXPECT_THAT(refusal(zero(2, "left", 1e17)), HasSubstr("use -1000000 to 1000000"));
  EXPECT_THAT(refusal(zero(3, "left", -1000001.0)), HasSubstr("out of range"));
}

TEST_F(RequestDeskTest, RefusesAnAngleThatIsNotFinite) {
  EXPECT_THAT(refusal(zero(1, "left", std::numeric_limits<double>::quiet_NaN())), HasSubstr("angle_deg"));
}

TEST_F(RequestDeskTest, AnUnknownOperationIsAnsweredWithTheOnesThereAre) {
  const auto text = refusal(linkRequest(1, "enabel"));
  EXPECT_THAT(text, HasSubstr("'enabel'"));
  for (const auto* word : {"enable", "enable_alone", "disable", "estop", "clear", "zero"})
    EXPECT_THAT(text, HasSubstr(word));
}

TEST_F(RequestDeskTest, AnUnknownMotorIsAnsweredWithTheOnesThereAre) {
  const auto text = refusal(linkRequest(1, "enable", "left,rihgt"));
  EXPECT_THAT(text, HasSubstr("'rihgt'"));
  EXPECT_THAT(text, HasSubstr("left, right, yaw"));
}

TEST_F(RequestDeskTest, AnEstopIsOneWhateverElseTheMessageSays) {
  const auto unknown_motor = begin(linkRequest(1, "estop", "nobody"));
  EXPECT_TRUE(unknown_motor.estop);
  EXPECT_EQ(unknown_motor.response->status, ResponseStatus::kRefused);
  auto not_finite = linkRequest(2, "estop");
  not_finite.value_count = 1;
  not_finite.values[0] = {.name = std::string_view{"angle_deg"}, .value = std::nan("")};
  EXPECT_TRUE(begin(not_finite).estop);
}

TEST_F(RequestDeskTest, AnEstopIsOneWhenTooManyRequestsAreOpen) {
  std::int64_t seq = 0;
  while (begin(linkRequest(++seq, "enable")).order) ASSERT_LT(seq, 1000);
  EXPECT_THAT(refusal(linkRequest(++seq, "enable")), HasSubstr("too many requests"));
  EXPECT_TRUE(begin(linkRequest(++seq, "estop")).estop);
}

TEST_F(RequestDeskTest, AClientThatAsksOnAndOnLeavesRoomForOthers) {
  std::int64_t seq = 0;
  int flood = 0;
  while (begin(linkRequest(++seq, "enable")).order) ++flood;
  EXPECT_EQ(flood, 32);
  auto other = linkRequest(1, "disable");
  other.client = std::string_view{"keyboard"};
  EXPECT_TRUE(begin(other).order);
}

TEST_F(RequestDeskTest, AnswersMakeRoomForMoreRequests) {
  std::vector<Order> orders;
  for (std::int64_t seq = 1; seq <= 32; ++seq) orders.push_back(*begin(linkRequest(seq, "enable")).order);
  EXPECT_FALSE(begin(linkRequest(33, "enable")).order);
  for (const auto& order : orders) EXPECT_TRUE(desk.finish(done(order)));
  EXPECT_TRUE(begin(linkRequest(34, "enable")).order);
}

TEST_F(RequestDeskTest, ARepeatedEstopIsOneToo) {
  const auto first = begin(linkRequest(1, "estop"));
  EXPECT_TRUE(begin(linkRequest(1, "estop")).estop);  // not answered yet
  ASSERT_TRUE(desk.finish(done(*first.order)));
  EXPECT_TRUE(begin(linkRequest(1, "estop")).estop);
}

TEST_F(RequestDeskTest, OtherOperationsRaiseNoEstop) {
  EXPECT_FALSE(begin(linkRequest(1, "estopp")).estop);
  EXPECT_FALSE(begin(linkRequest(2, "enable", "nobody")).estop);
}

TEST_F(RequestDeskTest, TheAnswerGoesToTheConnectionThatAskedAndCarriesItsNumbers) {
  const auto outcome = begin(linkRequest(42, "enable"));
  const auto answer = desk.finish(done(*outcome.order));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->connection, kConnection);
  EXPECT_EQ(answer->response.client.view(), "pilot");
  EXPECT_EQ(answer->response.session, 9U);
  EXPECT_EQ(answer->response.seq, 42);
  EXPECT_EQ(answer->response.status, ResponseStatus::kOk);
  EXPECT_EQ(answer->response.message.view(), "enable: 3 of 3 motors");
}

TEST_F(RequestDeskTest, AFailureNamesEachMotorAndItsReasonInWords) {
  const auto outcome = begin(linkRequest(1, "enable"));
  auto result = done(*outcome.order);
  result.motors[0] = Refusal::kOffline;
  result.motors[2] = Refusal::kFaulted;
  const auto answer = desk.finish(result);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->response.status, ResponseStatus::kFailed);
  const std::string text(answer->response.message.view());
  EXPECT_THAT(text, HasSubstr("1 of 3 motors"));
  EXPECT_THAT(text, HasSubstr("left: offline: no feedback"));
  EXPECT_THAT(text, HasSubstr("yaw: in FAULT"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("right:")));
}

TEST_F(RequestDeskTest, EveryReasonHasWordsOfItsOwn) {
  std::vector<std::string> seen;
  for (int reason = 1; reason <= static_cast<int>(Refusal::kTurnUnclear); ++reason) {
    const auto outcome = begin(linkRequest(reason, "enable", "left"));
    auto result = done(*outcome.order);
    result.motors[0] = static_cast<Refusal>(reason);
    seen.emplace_back(desk.finish(result)->response.message.view());
    EXPECT_THAT(seen.back(), ::testing::Not(HasSubstr("unknown reason")));
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::unique(seen.begin(), seen.end()), seen.end());
}

TEST_F(RequestDeskTest, AReasonHasTheNumbersOfItsMotorAndStandsOnceForThoseThatShareThem) {
  robot.motors[0].travel = robot.motors[2].travel = {-90.0, 200.0};
  robot.motors[1].travel = {0.0, 45.5};
  const auto outcome = begin(linkRequest(1, "enable"));
  auto result = done(*outcome.order);
  result.motors[0] = result.motors[1] = result.motors[2] = Refusal::kTurnUnclear;
  const std::string text(desk.finish(result)->response.message.view());
  EXPECT_THAT(text, HasSubstr("left, yaw: its turn is unclear: turn it by hand into its travel "
                              "(-90 to 200 deg)"));
  EXPECT_THAT(text, HasSubstr("right: its turn is unclear: turn it by hand into its travel (0 to 45.5 deg)"));
}

TEST_F(RequestDeskTest, ATravelWithOneEndIsToldByThatEnd) {
  robot.motors[0].travel.max_deg = 100.0;
  robot.motors[1].travel.min_deg = -20.0;
  const auto outcome = begin(linkRequest(1, "enable"));
  auto result = done(*outcome.order);
  result.motors[0] = result.motors[1] = Refusal::kOutOfReach;
  const std::string text(desk.finish(result)->response.message.view());
  EXPECT_THAT(text, HasSubstr("left: with this zero part of its travel (up to 100 deg) would lie beyond"));
  EXPECT_THAT(text, HasSubstr("right: with this zero part of its travel (from -20 deg) would lie beyond"));
}

TEST_F(RequestDeskTest, AMotorThatMayStillTurnIsWaitedForByItsOwnTime) {
  robot.motors[0].run_down = 7s;
  const auto outcome = begin(linkRequest(1, "clear"));
  auto result = done(*outcome.order);
  result.motors[0] = Refusal::kMayTurn;
  EXPECT_THAT(std::string(desk.finish(result)->response.message.view()),
              HasSubstr("left: no feedback, and it may still turn: wait until 7 s (run_down_s) after"));
}

TEST_F(RequestDeskTest, ReasonsOfMotorsThatWereNotAskedForDoNotCount) {
  const auto outcome = begin(linkRequest(1, "enable", "left"));
  auto result = done(*outcome.order);
  result.motors[1] = Refusal::kOffline;
  const auto answer = desk.finish(result);
  EXPECT_EQ(answer->response.status, ResponseStatus::kOk);
  EXPECT_EQ(answer->response.message.view(), "enable: 1 of 1 motors");
}

TEST_F(RequestDeskTest, AnOrderThatWasNotTriedIsRefused) {
  const auto outcome = begin(linkRequest(1, "enable"));
  auto result = done(*outcome.order);
  result.refused = true;
  EXPECT_EQ(desk.finish(result)->response.status, ResponseStatus::kRefused);
}

TEST_F(RequestDeskTest, ARepetitionGetsTheFirstAnswerAndNoNewOrder) {
  const auto outcome = begin(linkRequest(1, "enable"));
  auto result = done(*outcome.order);
  result.motors[1] = Refusal::kDriveRefused;
  const auto answer = desk.finish(result);
  const auto again = begin(linkRequest(1, "enable"));
  EXPECT_FALSE(again.order);
  ASSERT_TRUE(again.response);
  EXPECT_EQ(again.response->status, ResponseStatus::kFailed);
  EXPECT_EQ(again.response->message.view(), answer->response.message.view());
}

TEST_F(RequestDeskTest, ARepetitionWhileTheFirstIsOpenIsAnsweredOnceAndToTheLatestConnection) {
  const auto by = Speaker::Way::kLcm;  // the gateway was started again
  const auto outcome = desk.begin(linkRequest(1, "enable"), {.connection = 3, .way = by}, kAnyTime);
  const auto again = desk.begin(linkRequest(1, "enable"), {.connection = 4, .way = by}, kAnyTime);
  EXPECT_FALSE(again.order);
  EXPECT_FALSE(again.response);
  const auto answer = desk.finish(done(*outcome.order));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->connection, 4U);
  EXPECT_FALSE(desk.finish(done(*outcome.order)));
}

TEST_F(RequestDeskTest, AnotherClientSessionOrNumberIsAnotherRequest) {
  (void)desk.finish(done(*begin(linkRequest(1, "enable")).order));
  EXPECT_TRUE(begin(linkRequest(2, "enable")).order);
  auto request = linkRequest(1, "enable");
  request.session = 10;
  EXPECT_TRUE(begin(request).order);
  request = linkRequest(1, "enable");
  request.client = "remote";
  EXPECT_TRUE(begin(request).order);
}

TEST_F(RequestDeskTest, ARefusalIsRememberedToo) {
  (void)refusal(linkRequest(1, "enable", "nobody"));
  // The same number with another content is a repetition, not a new request.
  EXPECT_THAT(refusal(linkRequest(1, "enable", "left")), HasSubstr("'nobody'"));
}

TEST_F(RequestDeskTest, NoOtherProgramPushesAnAnswerOut) {
  const auto asked = linkRequest(1, "disable", "left");
  (void)desk.finish(done(*begin(asked).order));
  for (std::int64_t seq = 1; seq <= 200; ++seq) {
    auto other = linkRequest(seq, seq % 2 == 0 ? "dance" : "enable");
    other.client = "observer";
    const auto outcome = begin(other);
    if (outcome.order) (void)desk.finish(done(*outcome.order));
  }
  EXPECT_EQ(begin(asked).order->asked, Asked::kAgain) << "no second disable, which lets go of a load";
}

TEST_F(RequestDeskTest, AUserWithManyNamesPushesOutItsOwnAnswers) {
  const auto asked = linkRequest(1, "disable", "left");
  (void)desk.finish(done(*begin(asked).order));
  for (int name = 0; name < 40; ++name) {
    for (std::int64_t seq = 1; seq <= 60; ++seq) {
      auto other = linkRequest(seq, "dance");
      other.client = "observer" + std::to_string(name);
      (void)desk.begin(other, {.connection = kConnection + 1, .user = 1}, kAnyTime);
    }
  }
  EXPECT_EQ(begin(asked).order->asked, Asked::kAgain);
}

TEST_F(RequestDeskTest, WhatCouldNotBeHandedOverMaySucceedWhenRepeated) {
  const auto outcome = begin(linkRequest(1, "enable"));
  const auto failed = desk.fail(outcome.order->id, "the scheduler does not take orders");
  ASSERT_TRUE(failed);
  EXPECT_EQ(failed->connection, kConnection);
  EXPECT_EQ(failed->response.status, ResponseStatus::kFailed);
  EXPECT_EQ(failed->response.message.view(), "the scheduler does not take orders");
  EXPECT_TRUE(begin(linkRequest(1, "enable")).order);
}

TEST_F(RequestDeskTest, ResultsAndFailuresOfUnknownOrdersAreIgnored) {
  OrderResult result;
  result.id = 12345;
  EXPECT_FALSE(desk.finish(result));
  EXPECT_FALSE(desk.fail(12345, "reason"));
}

TEST_F(RequestDeskTest, AnAnswerBelongsToItsSenderAndOperation) {
  (void)desk.finish(done(*begin(linkRequest(1, "enable")).order));
  EXPECT_TRUE(desk.begin(linkRequest(1, "enable"), {.connection = kConnection, .user = 1}, kAnyTime).order);
  EXPECT_TRUE(begin(linkRequest(1, "clear")).order) << "a program that counts from 1 anew";
  // A message by LCM from another computer takes no answer away from a program of this one.
  (void)desk.finish(
      done(*desk.begin(linkRequest(2, "enable"), {.way = Speaker::Way::kNetwork}, kAnyTime).order));
  EXPECT_TRUE(desk.begin(linkRequest(2, "enable"), {.way = Speaker::Way::kLcm}, kAnyTime).order);
}

TEST_F(RequestDeskTest, WhatStopsIsNeverAnsweredFromMemory) {
  for (const auto* operation : {"disable", "estop"}) {
    const auto first = begin(linkRequest(1, operation, "left"));
    ASSERT_TRUE(first.order) << operation;
    EXPECT_EQ(first.order->asked, Asked::kAnew);
    const auto open = begin(linkRequest(1, operation, "left"));
    ASSERT_TRUE(open.order) << operation << " whose first is not answered yet";
    EXPECT_EQ(open.order->asked, Asked::kAgain);
    (void)desk.finish(done(*first.order));
    (void)desk.finish(done(*open.order));
    const auto again = begin(linkRequest(1, operation, "left"));
    ASSERT_TRUE(again.order) << operation;
    EXPECT_EQ(again.order->asked, Asked::kAgain);
    EXPECT_FALSE(again.response);
    EXPECT_EQ(begin(linkRequest(2, operation, "left")).order->asked, Asked::kAnew);
  }
}

TEST_F(RequestDeskTest, ADisableThatComesOfItselfAtTheEndOfAProgramIsNoSecondOne) {
  auto request = linkRequest(1, "disable", "left");
  request.value_count = 1;
  request.values[0].name = link::kAtEnd;
  request.values[0].value = 1.0;
  EXPECT_EQ(begin(request).order->asked, Asked::kUnasked);
  request.seq = 2;
  request.values[0].value = 0.0;
  EXPECT_EQ(begin(request).order->asked, Asked::kAnew);
}

/// Requests that rc10d finds when it goes on after a pause.
class LateRequestTest : public RequestDeskTest {
 protected:
  static constexpr MonotonicTime kNow{1h};

  RequestDesk::Outcome beginAfter(Duration waited, std::int64_t seq, std::string_view operation) {
    auto request = linkRequest(seq, operation, "left");
    request.received_ns = (kNow - waited).time_since_epoch().count();
    return desk.begin(request, {.connection = kConnection}, kNow);
  }
  static std::string textOf(const RequestDesk::Outcome& outcome) {
    return outcome.response ? std::string(outcome.response->message.view()) : std::string{};
  }
};

TEST_F(LateRequestTest, IsRefusedWhateverItAsksForUnlessItStops) {
  std::int64_t seq = 0;
  for (const auto* word : kOperationWords) {
    const auto in_time = beginAfter(kMaxRequestAge, ++seq, word);
    EXPECT_THAT(textOf(in_time), ::testing::Not(HasSubstr("ms old"))) << word;
    const auto late = beginAfter(30s, ++seq, word);
    if (stops(*operationNamed(word))) {
      ASSERT_TRUE(late.order) << word;
      EXPECT_EQ(late.estop, late.order->operation == Operation::kEstop);
      continue;
    }
    EXPECT_FALSE(late.order || late.shaft) << word;
    ASSERT_TRUE(late.response) << word;
    EXPECT_EQ(late.response->status, ResponseStatus::kRefused);
    EXPECT_EQ(textOf(late),
              "the request is 30000 ms old, since rc10d stood still or was not reached: it was not done; ask "
              "again");
  }
}

TEST_F(LateRequestTest, ItsRepetitionDoesNothingEitherButAnotherRequestDoes) {
  EXPECT_THAT(textOf(beginAfter(kMaxRequestAge + 1ns, 1, "clear")), HasSubstr("1000 ms old"));
  const auto again = beginAfter(0ns, 1, "clear");
  EXPECT_FALSE(again.order);
  EXPECT_THAT(textOf(again), HasSubstr("1000 ms old"));
  EXPECT_TRUE(beginAfter(0ns, 2, "clear").order);
}

TEST_F(LateRequestTest, OneThatWasDoneBeforeThePauseIsAnsweredAsThen) {
  (void)desk.finish(done(*beginAfter(0ns, 1, "enable").order));
  EXPECT_EQ(textOf(beginAfter(30s, 1, "enable")), "enable: 1 of 1 motors");
}

TEST_F(LateRequestTest, AStampThatCannotBeIsJudgedToo) {
  EXPECT_TRUE(beginAfter(-1h, 1, "enable").order) << "the future counts as now";
  auto request = linkRequest(2, "enable", "left");
  request.received_ns = std::numeric_limits<std::int64_t>::min();
  EXPECT_FALSE(desk.begin(request, {.connection = kConnection}, kNow).order);
}

TEST_F(RequestDeskTest, AnswersAreRememberedForAWhileOnly) {
  for (std::int64_t seq = 1; seq <= 65; ++seq)
    (void)desk.finish(done(*begin(linkRequest(seq, "clear")).order));
  EXPECT_TRUE(begin(linkRequest(65, "clear")).response);
  EXPECT_TRUE(begin(linkRequest(1, "clear")).order);
}

}  // namespace
}  // namespace rc10::test::request_desk_test
