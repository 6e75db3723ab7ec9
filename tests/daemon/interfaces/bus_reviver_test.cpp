// Without CAN: "lo" stands for an interface that is there but is no CAN interface. The
// revival itself is tested with real SocketCAN in tests/kernel.
#include "daemon/interfaces/bus_reviver.hpp"

#include <gtest/gtest.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstring>

#include "bus/wire_frame.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/interfaces/can_intake.hpp"

#include "daemon/virtual_robot.hpp"
#include "support/without_descriptors.hpp"

namespace rc10::test::bus_reviver_test {
namespace {

class BusReviverTest : public ::testing::Test {
 protected:
  void setInterface(const std::string& name) { robot->buses()[0].interface = name; }
  CanLinkState link() { return inboxes[0].link.load(); }
  static CanLinkState stateOfLoopback() {
    const UniqueFd any{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    ifreq request{};
    std::strcpy(request.ifr_name, "lo");
    EXPECT_EQ(::ioctl(any.get(), SIOCGIFFLAGS, &request), 0);
    return (request.ifr_flags & IFF_UP) != 0 ? CanLinkState::kUp : CanLinkState::kDown;
  }

  std::unique_ptr<Robot> robot = Robot::build(twoWheelsAndYaw()).value();
  std::array<BusInbox, kMaxBuses> inboxes;
  CanIntake intake{*robot, inboxes, monotonicNow()};
  LinkExchange exchange;
  InterfaceLocks locks;
  BusReviver reviver{*robot, inboxes, exchange, locks};
};

TEST_F(BusReviverTest, LeavesASimulatedBusAlone) {
  inboxes[0].link = CanLinkState::kDown;
  reviver.check(monotonicNow());
  EXPECT_EQ(link(), CanLinkState::kDown);
}

TEST_F(BusReviverTest, SeesThatAnInterfaceIsGone) {
  setInterface("rc10nosuch");
  reviver.check(monotonicNow());
  EXPECT_EQ(link(), CanLinkState::kGone);
}

TEST_F(BusReviverTest, ShowsWhetherAnInterfaceIsUp) {
  setInterface("lo");
  inboxes[0].link = stateOfLoopback() == CanLinkState::kUp ? CanLinkState::kDown : CanLinkState::kUp;
  reviver.check(monotonicNow());
  EXPECT_EQ(link(), stateOfLoopback());
}

TEST_F(BusReviverTest, WithoutDescriptorsNoInterfaceIsGone) {
  setInterface("lo");
  inboxes[0].link = stateOfLoopback();
  {
    const WithoutDescriptors none;
    reviver.check(monotonicNow());
  }
  EXPECT_EQ(link(), stateOfLoopback());
}

TEST_F(BusReviverTest, ABusThatWasDownBetweenTwoLooksHasComeUp) {
  setInterface("lo");
  (void)reviver.check(monotonicNow());
  inboxes[0].link = CanLinkState::kDown;  // a receive has met ENETDOWN
  EXPECT_EQ(reviver.check(monotonicNow()).test(0), stateOfLoopback() == CanLinkState::kUp);
  EXPECT_TRUE(reviver.check(monotonicNow()).none());
}

TEST_F(BusReviverTest, ABusStaysGoneUntilItsSocketIsReplaced) {
  setInterface("lo");
  inboxes[0].link = CanLinkState::kGone;
  reviver.check(monotonicNow());  // no CAN socket can be bound to lo
  EXPECT_EQ(link(), CanLinkState::kGone);
  // The descriptor is still the old one: what the drives send arrives.
  const CanFrame frame = makeClassicFrame({0x201, false}, std::array<std::uint8_t, 1>{1});
  canfd_frame wire;
  const auto size = encodeFrame(frame, wire);
  ASSERT_GT(::send(robot->simPorts()[0]->descriptor(), &wire, size, MSG_DONTWAIT), 0);
  intake.drain(monotonicNow());
  EXPECT_EQ(inboxes[0].frames.read_available(), 1U);
}

}  // namespace
}  // namespace rc10::test::bus_reviver_test
