#include "daemon/clients/disable_at_end.hpp"

#include <gmock/gmock.h>

#include "daemon/link_rig.hpp"
#include "link/until_its_end.hpp"

namespace rc10::test::disable_at_end_test {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kPage = 4;
constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;

link::Request asking(std::string_view operation, double value) {
  auto request = linkRequest(1, operation, "left");
  request.value_count = 1;
  request.values[0] = {.name = link::kDisableAtEnd, .value = value};
  return request;
}

class DisableAtEndTest : public ::testing::Test {
 protected:
  DisableAtEndTest() {
    now->motor_count = 2;
    now->tick = 100;
    motor(kLeft).status = motor(kRight).status = MotorStatus::kReady;
  }
  MotorSnapshot& motor(std::size_t i) { return now->motors[i]; }

  /// The page has enabled these, of which the drives have confirmed all but `offline`.
  void enable(const MotorSet& motors, std::optional<std::size_t> offline = {},
              const MotorSet& on_before = {}) {
    const Order order{
        .id = 7, .operation = Operation::kEnable, .motors = motors, .client = std::string_view{"web-1"}};
    at_end.add(order, kPage);
    OrderResult result;
    result.id = order.id;
    result.switched_on = motors & ~on_before;
    if (offline) result.motors[*offline] = Refusal::kOffline;
    at_end.finish(result, *now);
    for (std::size_t i = 0; i < 2; ++i) {
      if (!motors.test(i) || i == offline) continue;
      motor(i).status = MotorStatus::kActive;
      motor(i).enabled_by = order.id;
    }
    now->tick += 2;
  }
  std::optional<Order> due(bool is_open = false) {
    return at_end.due(*now, [=](std::uint64_t id) { return id != kPage || is_open; });
  }

  std::unique_ptr<Snapshot> now = std::make_unique<Snapshot>();
  DisableAtEnd at_end;
};

TEST_F(DisableAtEndTest, AMotorIsDisabledWhenTheConnectionHasEndedAndNotBefore) {
  enable(MotorSet{0b01});
  EXPECT_FALSE(due(true));
  const auto order = due();
  ASSERT_TRUE(order);
  EXPECT_EQ(order->operation, Operation::kDisable);
  EXPECT_EQ(order->motors, MotorSet{0b01});
  EXPECT_EQ(order->client.view(), "web-1");
  // It lets go of nothing that on_disable holds.
  EXPECT_EQ(order->asked, Asked::kUnasked);
  EXPECT_FALSE(order->fromModule());
}

TEST_F(DisableAtEndTest, AnOrderThatFoundNoRoomIsDueAgainAndOneThatWasTakenIsNot) {
  enable(MotorSet{0b01});
  ASSERT_TRUE(due());
  const auto order = due();
  ASSERT_TRUE(order);
  at_end.taken(*order);
  EXPECT_FALSE(due());
}

TEST_F(DisableAtEndTest, AMotorThatWasOnBeforeOrWasNotEnabledIsNotItsOwn) {
  motor(kLeft).status = MotorStatus::kActive;
  enable(MotorSet{0b11}, kRight, MotorSet{0b01});
  EXPECT_FALSE(due());
}

TEST_F(DisableAtEndTest, AMotorIsItsOwnThoughTheSnapshotShowsItOnBeforeTheLinkThreadLooks) {
  // The scheduler has taken the order already.
  motor(kLeft).status = MotorStatus::kEnabling;
  enable(MotorSet{0b01});
  EXPECT_TRUE(due());
}

TEST_F(DisableAtEndTest, AMotorThatWasOffSinceIsNotItsOwn) {
  enable(MotorSet{0b01});
  motor(kLeft).status = MotorStatus::kReady;
  EXPECT_FALSE(due(true));
  motor(kLeft).status = MotorStatus::kActive;
  EXPECT_FALSE(due());
}

TEST_F(DisableAtEndTest, AMotorThatItsGroupMayBringBackIsStillItsOwn) {
  for (const auto cause : {StopCause::kSilence, StopCause::kGroup}) {
    motor(kLeft).status = MotorStatus::kReady;
    enable(MotorSet{0b01});
    motor(kLeft).status = MotorStatus::kReady;
    motor(kLeft).stop.cause = cause;
    motor(kLeft).acting = Acting::kBrake;
    EXPECT_FALSE(due(true));
    const auto while_off = due();
    ASSERT_TRUE(while_off) << "which ends the return";
    EXPECT_EQ(while_off->asked, Asked::kUnasked) << "and lets go of nothing";
    motor(kLeft).status = MotorStatus::kActive;
    motor(kLeft).acting = Acting::kNothing;
    const auto returned = due();
    ASSERT_TRUE(returned);
    at_end.taken(*returned);
    motor(kLeft).stop = {};
  }
}

TEST_F(DisableAtEndTest, AMotorThatAnotherRequestBringsBackIsThatOnes) {
  enable(MotorSet{0b01});
  motor(kLeft).status = MotorStatus::kReady;
  motor(kLeft).stop.cause = StopCause::kGroup;
  EXPECT_FALSE(due(true));
  // Its drive has not answered yet.
  motor(kLeft).status = MotorStatus::kEnabling;
  motor(kLeft).enabled_by = 8;
  EXPECT_FALSE(due());
  motor(kLeft).status = MotorStatus::kActive;
  EXPECT_FALSE(due());
}

TEST_F(DisableAtEndTest, ASnapshotFromBeforeTheResultSaysNothing) {
  enable(MotorSet{0b01});
  now->tick -= 1;
  motor(kLeft).status = MotorStatus::kReady;
  EXPECT_FALSE(due());
  now->tick += 1;
  motor(kLeft).status = MotorStatus::kActive;
  EXPECT_TRUE(due());
}

TEST_F(DisableAtEndTest, ItsLastTargetActsToItsEnd) {
  enable(MotorSet{0b01});
  motor(kLeft).owner = "web-1";
  motor(kLeft).acting = Acting::kTarget;
  EXPECT_FALSE(due());
  motor(kLeft).owner = "";
  motor(kLeft).acting = Acting::kRamp;
  EXPECT_FALSE(due());
  motor(kLeft).acting = Acting::kDamp;
  EXPECT_TRUE(due());
}

TEST_F(DisableAtEndTest, AMotorThatAnotherClientMovesIsThatClients) {
  enable(MotorSet{0b01});
  motor(kLeft).owner = "planner";
  motor(kLeft).acting = Acting::kTarget;
  EXPECT_FALSE(due());
  motor(kLeft).owner = "";
  motor(kLeft).acting = Acting::kNothing;
  EXPECT_FALSE(due());
}

TEST_F(DisableAtEndTest, AMotorThatItsOnTimeoutHoldsIsHeldOn) {
  for (const auto acting : {Acting::kHold, Acting::kBrake}) {
    motor(kLeft).status = MotorStatus::kReady;
    enable(MotorSet{0b01});
    motor(kLeft).acting = acting;
    EXPECT_FALSE(due());
    motor(kLeft).acting = Acting::kNothing;
    EXPECT_FALSE(due());
  }
}

TEST_F(DisableAtEndTest, ItIsAskedForByOneAndOnlyOfWhatEnables) {
  const Speaker speaker;
  EXPECT_TRUE(DisableAtEnd::askedBy(asking("enable", 1.0), Operation::kEnable, speaker).value());
  EXPECT_TRUE(DisableAtEnd::askedBy(asking("enable_alone", 1.0), Operation::kEnableAlone, speaker).value());
  EXPECT_FALSE(DisableAtEnd::askedBy(asking("enable", 0.0), Operation::kEnable, speaker).value());
  EXPECT_FALSE(DisableAtEnd::askedBy(linkRequest(1, "enable"), Operation::kEnable, speaker).value());
  EXPECT_FALSE(DisableAtEnd::askedBy(asking("disable", 1.0), Operation::kDisable, speaker).value());
  EXPECT_FALSE(DisableAtEnd::askedBy(asking("enable", 0.5), Operation::kEnable, speaker));
}

class DisableAtEndLinkTest : public LinkRig {};

TEST_F(DisableAtEndLinkTest, AClientThatIsKilledHasItsMotorDisabled) {
  publishSnapshot(1);
  auto client = join(0, "web-1");
  auto request = asking("enable", 1.0);
  request.client = "web-1";
  ASSERT_TRUE(client->send(request));
  pump();
  const auto enabling = takeOrder();
  const auto order_id = enabling.id;
  finish(enabling);
  ASSERT_TRUE(await<link::Response>(*client));
  for (int i = 0; i < 3; ++i) {
    exchange.snapshot.slot().motors[kLeft].status = MotorStatus::kActive;
    exchange.snapshot.slot().motors[kLeft].enabled_by = order_id;
    publishSnapshot(10);
  }
  client->leave();
  Order order;
  for (int i = 0; i < 3000 && !exchange.orders.pop(order); ++i) server->poll(100);
  EXPECT_EQ(order.operation, Operation::kDisable);
  EXPECT_EQ(order.motors, MotorSet{0b01});
  EXPECT_EQ(order.client.view(), "web-1");
}

TEST_F(DisableAtEndLinkTest, AProgramOfLcmIsRefusedInWords) {
  auto gateway = join(0, link::kGatewayClient);
  ASSERT_TRUE(gateway->send(asking("enable", 1.0)));
  const auto response = await<link::Response>(*gateway);
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kRefused);
  EXPECT_THAT(std::string(response->message.view()), HasSubstr("nobody sees the end of an LCM client"));
}

}  // namespace
}  // namespace rc10::test::disable_at_end_test
