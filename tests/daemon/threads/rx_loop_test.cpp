#include "daemon/threads/rx_loop.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "bus/socket_pair.hpp"
#include "bus/wire_frame.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::rx_loop_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime at(Duration time) { return MonotonicTime{time}; }

// The wire is a socket pair; the simulated drives at its other end are never stepped.
class RxLoopTest : public ::testing::Test {
 protected:
  void write() {
    const CanFrame frame = makeClassicFrame({0x201, false}, std::array<std::uint8_t, 1>{1});
    canfd_frame wire;
    const auto size = encodeFrame(frame, wire);
    ASSERT_GT(::send(robot->simPorts()[0]->descriptor(), &wire, size, MSG_DONTWAIT), 0);
  }
  std::size_t frames() { return inboxes[0].frames.read_available(); }

  std::unique_ptr<Robot> robot = Robot::build(twoWheelsAndYaw()).value();
  std::array<BusInbox, kMaxBuses> inboxes;
  CanIntake intake{*robot, inboxes, at(4s)};
  // 100 us before ticks at 0.3 of a millisecond.
  std::unique_ptr<RxLoop> loop =
      RxLoop::create(nullptr, RxLoop::Drain{intake, TimeGrid{1ms, 300us}.shifted(-100us)}).value();
};

TEST_F(RxLoopTest, DrainsTheBusesOnceAPeriodOnItsGrid) {
  EXPECT_EQ(loop->turn(at(5s)), at(5s + 1200us)) << "the first point that is not too close";
  write();
  EXPECT_EQ(loop->turn(at(5s + 1199us)), at(5s + 1200us));
  EXPECT_EQ(frames(), 0U);
  EXPECT_EQ(loop->turn(at(5s + 1200us)), at(5s + 2200us)) << "however long the drain takes";
  EXPECT_EQ(frames(), 1U);
  write();
  EXPECT_EQ(loop->turn(at(5s + 1300us)), at(5s + 2200us));
  EXPECT_EQ(frames(), 1U);
}

TEST_F(RxLoopTest, StaysOnItsGridHoweverLateItIs) {
  (void)loop->turn(at(5s));
  write();
  EXPECT_EQ(loop->turn(at(5s + 9900us)), at(5s + 10200us));
  EXPECT_EQ(frames(), 1U);
}

TEST_F(RxLoopTest, WithoutBusesItTurnsTenTimesASecond) {
  const auto idle = RxLoop::create(nullptr).value();
  EXPECT_EQ(idle->turn(at(5s)), at(5s + 100ms));
}

TEST_F(RxLoopTest, FramesWakeNobody) {
  write();
  const auto before = loop->wakeUps();
  loop->poll(0ns);
  EXPECT_EQ(frames(), 0U);
  EXPECT_EQ(loop->wakeUps(), before + 1) << "every wake-up is counted";
}

TEST_F(RxLoopTest, ADrainWaitsForNoRest) {
  const SocketPair wire;
  LinkExchange exchange;
  const auto both = RxLoop::create(nullptr, RxLoop::Drain{intake, TimeGrid{1ms, 300us}},
                                   RxLoop::Estops{EstopDatagrams{wire.near.get()}, exchange})
                        .value();
  EXPECT_EQ(both->turn(at(5s)), at(5s + 1300us));
  wire.write("", 0);
  both->look(at(5s + 1299us));
  EXPECT_TRUE(exchange.estop_datagram.load());
  write();
  EXPECT_EQ(both->turn(at(5s + 1300us)), at(5s + 2300us));
  EXPECT_EQ(frames(), 1U);
}

TEST_F(RxLoopTest, EndsWhenItIsAskedTo) {
  std::stop_source stop;
  stop.request_stop();
  loop->run(stop.get_token());
  EXPECT_EQ(loop->wakeUps(), 0U);
}

// A port and the socket of e-stops, each with somebody at the other end who sends as much as there is room
// for. Looks are in virtual time.
class RxLoopFloodTest : public ::testing::Test {
 protected:
  RxLoopFloodTest() {
    EXPECT_GE(::dup3(port.near.get(), channel().fd.get(), O_CLOEXEC), 0);
    EXPECT_TRUE(loop->watchSerial(0));
  }
  SerialChannel& channel() { return (*channels)[0]; }
  static void flood(const SocketPair& wire) {
    const std::array<std::uint8_t, 8> bytes{'f', 'l', 'o', 'o', 'd'};
    while (::send(wire.far.get(), bytes.data(), bytes.size(), MSG_DONTWAIT) > 0) {
    }
  }
  [[nodiscard]] std::size_t chunks() { return channel().chunks.read_available(); }
  /// Whether the scheduler would see an e-stop now.
  [[nodiscard]] bool stops() { return exchange.estop_datagram.exchange(false); }
  [[nodiscard]] std::string client() { return std::string{exchange.estop_datagram_client.read().view()}; }

  SocketPair port;
  SocketPair estops;
  LinkExchange exchange;
  std::unique_ptr<SerialChannels> channels =
      SerialChannels::create(std::vector<SerialChannel::Settings>{{"imu", "/dev/none"}}).value();
  std::unique_ptr<RxLoop> loop = RxLoop::create(channels.get(), std::nullopt,
                                                RxLoop::Estops{EstopDatagrams{estops.near.get()}, exchange})
                                     .value();
};

TEST_F(RxLoopFloodTest, FloodsAreReadFourTimesAMillisecond) {
  int stopped = 0;
  const AllocGuard guard;
  for (int i = 0; i < 1000; ++i) {
    flood(port);
    flood(estops);
    loop->look(at(5s + i * 1us));
    stopped += stops() ? 1 : 0;
  }
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_EQ(chunks(), 4U);
  EXPECT_EQ(stopped, 4);
}

TEST_F(RxLoopFloodTest, WhileItRestsBytesDoNotWakeIt) {
  port.write("a", 1);
  loop->look(monotonicNow() + 1h);
  ASSERT_EQ(chunks(), 1U);
  port.write("b", 1);
  for (int i = 0; i < 5; ++i) loop->poll(1us);
  EXPECT_EQ(chunks(), 1U);
  EXPECT_EQ(loop->wakeUps(), 5U) << "it turns, for the drain and the watchdog";
}

TEST_F(RxLoopFloodTest, ALookThatFoundNothingIsFollowedByNoRest) {
  loop->look(at(5s));
  port.write("a", 1);
  loop->look(at(5s + 1us));
  EXPECT_EQ(chunks(), 1U);
}

TEST_F(RxLoopFloodTest, AnEstopIsTakenBesideAPortThatFloods) {
  flood(port);
  estops.write("pult", 4);
  estops.write("second", 6);
  loop->poll(0ns);
  EXPECT_TRUE(stops());
  EXPECT_EQ(client(), "pult") << "the first";
  EXPECT_FALSE(stops()) << "once";
}

TEST_F(RxLoopFloodTest, AnEstopWithoutANameOrWithOneThatIsTooLongIsOneToo) {
  estops.write("", 0);
  loop->look(at(5s));
  EXPECT_TRUE(stops());
  EXPECT_EQ(client(), "");
  const std::string name(1000, 'n');
  estops.write(name.data(), name.size());
  loop->look(at(6s));
  EXPECT_TRUE(stops());
  EXPECT_EQ(client(), std::string(31, 'n'));
}

// A socket that listens is readable when somebody calls, and each read of it is an error: no hang-up.
TEST_F(RxLoopFloodTest, APortWhoseReadsFailIsLeftAndNotLookedAtAgain) {
  const UniqueFd listener{::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socklen_t size = sizeof(sa_family_t);  // the kernel gives it a name
  ASSERT_EQ(::bind(listener.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(listener.get(), 1), 0);
  size = sizeof address;
  ASSERT_EQ(::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  const UniqueFd caller{::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  ASSERT_EQ(::connect(caller.get(), reinterpret_cast<const sockaddr*>(&address), size), 0);
  ASSERT_GE(::dup3(listener.get(), channel().fd.get(), O_CLOEXEC), 0);
  ASSERT_TRUE(loop->watchSerial(0));
  channel().state.store(SerialState::kOpen);

  for (int i = 0; i < 100; ++i) loop->look(at(5s + i * 1ms));
  EXPECT_EQ(channel().state.load(), SerialState::kAbsent);
  EXPECT_EQ(channel().hang_ups.load(), 1U);
  EXPECT_EQ(chunks(), 0U);
}

TEST_F(RxLoopFloodTest, WithoutItsSocketOfEstopsThereIsNoLoop) {
  const UniqueFd file{::open("/", O_RDONLY | O_CLOEXEC)};
  const auto refused =
      RxLoop::create(nullptr, std::nullopt, RxLoop::Estops{EstopDatagrams{file.get()}, exchange});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "the socket of e-stops cannot be watched: epoll_ctl: Operation not permitted");
}

}  // namespace
}  // namespace rc10::test::rx_loop_test
