// Care of the io thread for a CAN link, with a driver that only remembers. The real one is tested with
// controllers, in tests/vm.
#include "daemon/interfaces/can_link_keeper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::can_link_keeper_test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

CanLink linkOf(bool up, const char* kind) {
  CanLink link;
  link.up = up;
  link.kind = kind;
  return link;
}

CanLink activeController() {
  CanLink link = linkOf(true, "can");
  link.bitrate = 1'000'000;
  link.bus_off = false;
  return link;
}

struct FakeLink {
  CanLink link = activeController();
  std::string refusal;
  int restarts = 0;
  int reads = 0;
};

FakeLink& fakeLink() {
  static FakeLink link;
  return link;
}

Result<CanLink> readFake(const std::string&) {
  ++fakeLink().reads;
  return fakeLink().link;
}

Result<void> restartFake(const std::string& interface, const CanLinkSettings& wanted) {
  if (!fakeLink().refusal.empty()) return fail(fakeLink().refusal);
  EXPECT_EQ(interface, "can7");
  EXPECT_EQ(wanted.bitrate, 1'000'000);
  ++fakeLink().restarts;
  return {};
}

class CanLinkKeeperTest : public ::testing::Test {
 protected:
  CanLinkKeeperTest() {
    fakeLink() = {};
    robot->buses()[0].interface = "can7";
    robot->buses()[0].settings.bitrate = 1'000'000;
  }

  void manage() { robot->buses()[0].manage_link = true; }
  void run(BusState state, Duration time) {
    inboxes[0].state = state;
    for (const auto end = now + time; now < end; now += 50ms) keeper.check(now, {});
  }
  void comesUp() { keeper.check(now, 0b1); }
  /// The texts of all events since the last call.
  std::vector<std::string> told() {
    std::vector<std::string> out;
    link::Event note;
    while (exchange.notes.pop(note)) {
      EXPECT_EQ(note.code, 301);
      EXPECT_EQ(note.source.view(), "chassis");
      out.emplace_back(note.text.view());
    }
    return out;
  }

  std::unique_ptr<Robot> robot = Robot::build(twoWheelsAndYaw()).value();
  std::array<BusInbox, kMaxBuses> inboxes;
  LinkExchange exchange;
  CanLinkKeeper keeper{*robot, inboxes, exchange, {readFake, restartFake}};
  MonotonicTime now{1000s};
};

TEST_F(CanLinkKeeperTest, ABusThatIsWellIsNotAskedFor) {
  manage();
  run(BusState::kActive, 10s);
  EXPECT_EQ(fakeLink().reads, 0);
  EXPECT_EQ(fakeLink().restarts, 0);
}

TEST_F(CanLinkKeeperTest, ASimulatedBusIsLeftAlone) {
  robot->buses()[0].interface.clear();
  run(BusState::kBusOff, 1s);
  EXPECT_EQ(fakeLink().reads, 0);
}

TEST_F(CanLinkKeeperTest, AManagedBusIsRestartedWithBackOffAndToldEachTime) {
  manage();
  run(BusState::kBusOff, 400ms);
  EXPECT_EQ(fakeLink().restarts, 3);
  EXPECT_THAT(told(), ::testing::Each(HasSubstr("bus-off: can7 taken down and up at 1000000 bit/s")));
}

TEST_F(CanLinkKeeperTest, ARestartIsSeenByTheSchedulerAsALinkThatWasDown) {
  manage();
  inboxes[0].link = CanLinkState::kUp;
  run(BusState::kStalled, 100ms);
  EXPECT_EQ(inboxes[0].link.load(), CanLinkState::kDown) << "the reviver shows it up again, at its next look";
}

TEST_F(CanLinkKeeperTest, AnEndlessTroubleIsNotToldForEver) {
  manage();
  run(BusState::kStalled, 60s);
  EXPECT_GT(fakeLink().restarts, 30);
  const auto texts = told();
  ASSERT_EQ(texts.size(), 7U);
  EXPECT_THAT(texts.back(),
              AllOf(HasSubstr("without telling it again"), HasSubstr("another node is powered")));
}

TEST_F(CanLinkKeeperTest, WhatIsRefusedIsToldOnceWithItsReason) {
  manage();
  fakeLink().refusal = "no permission";
  run(BusState::kBusOff, 10s);
  EXPECT_THAT(told(), ::testing::ElementsAre("no permission"));
  fakeLink().refusal.clear();
  run(BusState::kBusOff, 2s);
  EXPECT_EQ(fakeLink().restarts, 1);
}

TEST_F(CanLinkKeeperTest, WithoutManageLinkTheCommandIsToldOnceForEachTrouble) {
  fakeLink().link.bus_off = true;
  const auto wanted =
      HasSubstr("type: ip link set can7 down; ip link set can7 up type can bitrate 1000000 restart-ms 0");
  run(BusState::kBusOff, 10s);
  EXPECT_EQ(fakeLink().restarts, 0);
  EXPECT_THAT(told(),
              ::testing::ElementsAre(AllOf(wanted, HasSubstr("wiring"), HasSubstr("manage_link: true"))));
  run(BusState::kActive, 6s);
  run(BusState::kStalled, 10s);
  EXPECT_THAT(told(), ::testing::ElementsAre(AllOf(wanted, HasSubstr("another node"))));
}

TEST_F(CanLinkKeeperTest, AnInterfaceThatIsDownNeedsOneCommand) {
  run(BusState::kDown, 1s);
  EXPECT_THAT(told(), ::testing::ElementsAre(HasSubstr(
                          "can7 is down; type: ip link set can7 up type can bitrate 1000000 restart-ms 0")));
}

TEST_F(CanLinkKeeperTest, AVirtualInterfaceHasNoBitRateToSetAndNothingToManage) {
  fakeLink().link = linkOf(false, "vcan");
  run(BusState::kDown, 1s);
  EXPECT_THAT(told(), ::testing::ElementsAre("can7 is down; type: ip link set can7 up"));
}

TEST_F(CanLinkKeeperTest, ALostMessageAboutARestartIsMadeGood) {
  run(BusState::kBusOff, 100ms);  // the driver says that it is not
  EXPECT_EQ(inboxes[0].controller_running.load(), 1U);
  EXPECT_THAT(told(), IsEmpty());
}

TEST_F(CanLinkKeeperTest, ABusThatComesUpWithAnotherBitRateIsToldOrMended) {
  fakeLink().link.bitrate = 500'000;
  comesUp();
  EXPECT_THAT(told(),
              ::testing::ElementsAre(AllOf(HasSubstr("can7 is set to 500000 bit/s"),
                                           HasSubstr("the configuration says 1000000; type: ip link"))));
  EXPECT_EQ(fakeLink().restarts, 0);
  manage();
  comesUp();
  EXPECT_EQ(fakeLink().restarts, 1);
  EXPECT_THAT(told(), ::testing::ElementsAre(AllOf(HasSubstr("can7 is set to 500000 bit/s"),
                                                   HasSubstr("taken down and up at 1000000 bit/s"))));
}

TEST_F(CanLinkKeeperTest, ARestartForTheSettingsIsNotRepeatedBecauseItTookTheLinkDown) {
  manage();
  fakeLink().link.bitrate = 500'000;
  inboxes[0].state = BusState::kDown;  // somebody took it down and up, to change its settings
  comesUp();
  EXPECT_EQ(fakeLink().restarts, 1);
  fakeLink().link.bitrate = 1'000'000;
  now += 50ms;
  run(BusState::kDown, 50ms);  // the scheduler has not seen it up yet
  run(BusState::kActive, 10s);
  EXPECT_EQ(fakeLink().restarts, 1);
  EXPECT_THAT(told(), ::testing::ElementsAre(HasSubstr("can7 is set to 500000 bit/s")));
}

TEST_F(CanLinkKeeperTest, ALinkThatStaysDownAfterARestartForItsSettingsIsRestartedAgain) {
  manage();
  fakeLink().link.bitrate = 500'000;
  inboxes[0].state = BusState::kDown;
  comesUp();
  now += 50ms;
  run(BusState::kDown, 200ms);
  EXPECT_EQ(fakeLink().restarts, 2);
}

TEST_F(CanLinkKeeperTest, AnFdBusThatComesUpClassicOrWithAnotherDataRateIsToldOrMended) {
  robot->buses()[0].settings.data_bitrate = 5'000'000;
  comesUp();
  EXPECT_THAT(told(),
              ::testing::ElementsAre(HasSubstr(
                  "can7 has CAN FD off, the configuration has data_bitrate; type: ip link set can7 down; "
                  "ip link set can7 up type can bitrate 1000000 dbitrate 5000000 fd on restart-ms 0")));
  fakeLink().link.fd_on = true;
  fakeLink().link.data_bitrate = 2'000'000;
  manage();
  comesUp();
  EXPECT_EQ(fakeLink().restarts, 1);
  EXPECT_THAT(told(), ::testing::ElementsAre(
                          AllOf(HasSubstr("can7 is set to 2000000 bit/s in the data phase"),
                                HasSubstr("taken down and up at 1000000 bit/s, data 5000000 bit/s"))));
  fakeLink().link.data_bitrate = 5'000'000;
  comesUp();  // by our restart
  comesUp();
  EXPECT_EQ(fakeLink().restarts, 1);
}

TEST_F(CanLinkKeeperTest, ADriverThatCannotSetTheBitRateIsNotRestartedForEver) {
  manage();
  fakeLink().link.bitrate = 500'000;
  comesUp();
  comesUp();  // by our restart
  run(BusState::kActive, 10s);
  EXPECT_EQ(fakeLink().restarts, 1);
}

TEST_F(CanLinkKeeperTest, ABitRateThatTheDriverRoundsIsTheSame) {
  fakeLink().link.bitrate = 999'999;
  EXPECT_THAT(settingsAdvice("can7", fakeLink().link, {.bitrate = 1'000'000}), IsEmpty());
  fakeLink().link.bitrate = 980'000;
  EXPECT_THAT(settingsAdvice("can7", fakeLink().link, {.bitrate = 1'000'000}), Not(IsEmpty()));
}

TEST_F(CanLinkKeeperTest, TheDriversAutomaticRestartIsTold) {
  fakeLink().link.restart_ms = 100;
  EXPECT_THAT(settingsAdvice("can7", fakeLink().link, {.bitrate = 1'000'000}),
              AllOf(HasSubstr("100 ms after bus-off"), HasSubstr("restart-ms 0")));
  fakeLink().link.kind = "vcan";
  EXPECT_THAT(settingsAdvice("can7", fakeLink().link, {.bitrate = 1'000'000}), IsEmpty());
}

}  // namespace
}  // namespace rc10::test::can_link_keeper_test
