#include "daemon/threads/rx_loop.hpp"

#include <sys/socket.h>

#include <gtest/gtest.h>

#include "bus/wire_frame.hpp"
#include "daemon/virtual_robot.hpp"

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

TEST_F(RxLoopTest, EndsWhenItIsAskedTo) {
  std::stop_source stop;
  stop.request_stop();
  loop->run(stop.get_token());
  EXPECT_EQ(loop->wakeUps(), 0U);
}

}  // namespace
}  // namespace rc10::test::rx_loop_test
