#include "daemon/threads/io_loop.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <thread>

#include "daemon/serial_rig.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::io_loop_test {
namespace {

TEST(IoLoop, EndsWhenItIsAskedTo) {
  auto robot = Robot::build(twoWheelsAndYaw()).value();
  robot->buses()[0].interface = "rc10nosuch";
  std::array<BusInbox, kMaxBuses> inboxes;
  LinkExchange exchange;
  InterfaceLocks locks;
  IoLoop loop{BusReviver{*robot, inboxes, exchange, locks}, CanLinkKeeper{*robot, inboxes, exchange},
              nullptr};
  std::stop_source stop;
  stop.request_stop();
  loop.run(stop.get_token());
  EXPECT_EQ(inboxes[0].link.load(), CanLinkState::kUp);
}

TEST(IoLoop, LooksAfterSerialPorts) {
  SerialRig rig;
  rig.plugIn();
  auto serial = std::make_unique<SerialIo>(
      SerialIo{SerialReviver{*rig.channels, rig.watch(), rig.exchange}, SerialWriter{*rig.channels}});
  InterfaceLocks locks;
  IoLoop loop{BusReviver{*rig.robot, rig.inboxes, rig.exchange, locks},
              CanLinkKeeper{*rig.robot, rig.inboxes, rig.exchange}, nullptr, std::move(serial)};
  std::jthread io([&](const std::stop_token& stop) { loop.run(stop); });
  ASSERT_TRUE(rig.pump([&] { return rig.device.state() == SerialState::kOpen; }));
  const std::array<std::uint8_t, 2> bytes{4, 2};
  EXPECT_TRUE(rig.device.send(bytes));
  pollfd wait{.fd = rig.pty->master(), .events = POLLIN, .revents = 0};
  EXPECT_EQ(::poll(&wait, 1, 20'000), 1);
}

}  // namespace
}  // namespace rc10::test::io_loop_test
