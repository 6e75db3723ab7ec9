#include "daemon/interfaces/can_intake.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <optional>
#include <vector>

#include "bus/socket_pair.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/frame_calls.hpp"

namespace rc10::test::can_intake_test {
namespace {

// Two buses whose wire is a socket pair; the simulated drives at the other end are never stepped.
class CanIntakeTest : public ::testing::Test {
 protected:
  CanIntakeTest() {
    auto config = twoWheelsAndYaw();
    config.buses.push_back(config.buses[0]);
    config.buses[1].name = "arm";
    for (auto& motor : config.buses[1].motors) motor.settings.name = "arm_" + motor.settings.name;
    robot = Robot::build(config).value();
    intake.emplace(*robot, inboxes, monotonicNow());
  }
  ~CanIntakeTest() override { frameCalls() = {}; }

  void write(const CanFrame& frame, std::size_t bus = 0) {
    canfd_frame wire;
    const auto size = encodeFrame(frame, wire);
    ASSERT_EQ(::send(robot->simPorts()[bus]->descriptor(), &wire, size, MSG_DONTWAIT),
              static_cast<ssize_t>(size));
  }
  /// A frame as the drives' end of a socket pair stamps it.
  void writeStamped(const CanFrame& frame) {
    StampedFrame wire;
    const auto size = encodeFrame(frame, wire);
    ASSERT_EQ(::send(robot->simPorts()[0]->descriptor(), &wire, size, MSG_DONTWAIT),
              static_cast<ssize_t>(size));
  }
  /// The numbers of the frames in the ring, which is empty afterwards.
  std::vector<int> numbers(std::size_t bus = 0) {
    std::vector<int> out;
    inboxes[bus].frames.consume_all([&](const CanFrame& frame) { out.push_back(frame.data[0]); });
    return out;
  }

  void drain() { intake->drain(monotonicNow()); }

  std::unique_ptr<Robot> robot;
  std::array<BusInbox, kMaxBuses> inboxes;
  std::optional<CanIntake> intake;
};

TEST_F(CanIntakeTest, FramesReachTheRingOfTheirBusInTheirOrder) {
  for (std::uint8_t i = 1; i <= 3; ++i) write(numbered(i));
  write(numbered(9), 1);
  drain();
  EXPECT_EQ(numbers(0), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(numbers(1), std::vector<int>{9});
}

TEST_F(CanIntakeTest, ABurstLongerThanOneReadComesInOneDrainAndInItsOrder) {
  std::vector<int> expected;
  for (std::uint8_t i = 0; i < 200; ++i) {
    write(numbered(i));
    expected.push_back(i);
  }
  drain();
  EXPECT_EQ(numbers(), expected);
}

TEST_F(CanIntakeTest, ADrainIsOneSystemCallForEachBus) {
  for (std::uint8_t i = 0; i < 10; ++i) write(numbered(i));
  frameCalls() = {};
  drain();
  EXPECT_EQ(frameCalls().recvmmsg, 2U);
}

TEST_F(CanIntakeTest, AFloodCostsABoundedNumberOfSystemCallsAndKeepsItsOrder) {
  frameCalls() = {};
  frameCalls().received = [&](msghdr&) { write(numbered(1)); };  // one more for each that is taken
  for (int i = 0; i < 64; ++i) write(numbered(1));
  drain();
  EXPECT_EQ(frameCalls().recvmmsg, CanIntake::kMaxReads + 1U) << "and one of the other bus";
}

TEST_F(CanIntakeTest, AFrameKeepsTheStampOfItsReception) {
  const auto tick = monotonicNow();
  CanFrame frame = numbered(1);
  frame.received = tick - std::chrono::microseconds{700};
  writeStamped(frame);
  intake->drain(tick);
  CanFrame got;
  ASSERT_TRUE(inboxes[0].frames.pop(got));
  EXPECT_EQ(got.received, frame.received);
}

TEST_F(CanIntakeTest, AFrameIsAsOldAsItsReceptionByTheKernelHoweverLateItsDrain) {
  constexpr std::chrono::milliseconds kLate{5};
  write(numbered(1));
  const auto after = monotonicNow();
  while (monotonicNow() < after + kLate) {
  }
  drain();
  CanFrame frame;
  ASSERT_TRUE(inboxes[0].frames.pop(frame));
  EXPECT_LE(frame.received, after + kLate / 5) << "by two clocks, read one after the other";
}

TEST_F(CanIntakeTest, NoFrameIsYoungerThanTheTickThatTakesIt) {
  const auto tick = monotonicNow();
  CanFrame frame = numbered(1);
  frame.received = tick + std::chrono::microseconds{30};
  writeStamped(frame);
  intake->drain(tick);
  CanFrame got;
  ASSERT_TRUE(inboxes[0].frames.pop(got));
  EXPECT_EQ(got.received, tick);
}

TEST_F(CanIntakeTest, CountsTheFramesThatAFullRingCannotTakeAndKeepsTheOldestOnes) {
  for (std::size_t i = 0; i < BusInbox::kFrames - 1; ++i) {
    ASSERT_TRUE(inboxes[0].frames.push(numbered(1)));
  }
  for (std::uint8_t i = 2; i <= 5; ++i) write(numbered(i));
  drain();
  EXPECT_EQ(inboxes[0].dropped.load(), 3U);
  EXPECT_EQ(inboxes[1].dropped.load(), 0U);
  const auto seen = numbers();
  ASSERT_EQ(seen.size(), BusInbox::kFrames);
  EXPECT_EQ(seen.back(), 2);
  write(numbered(6));
  drain();
  EXPECT_EQ(numbers(), std::vector<int>{6});
}

TEST_F(CanIntakeTest, AddsWhatTheKernelDropped) {
  const auto receive = [&](std::uint32_t kernel_dropped) {
    frameCalls().received = [=](msghdr& message) { reportDropped(message, kernel_dropped); };
    write(numbered(1));
    drain();
    return inboxes[0].dropped.load();
  };
  EXPECT_EQ(receive(5), 5U);
  EXPECT_EQ(receive(5), 5U);
  EXPECT_EQ(receive(8), 8U);
  EXPECT_EQ(receive(0), 8U) << "a socket that was opened anew: it has dropped none yet";
  EXPECT_EQ(receive(95), 103U);
  EXPECT_EQ(receive(97), 105U);
}

TEST_F(CanIntakeTest, CountsMalformedMessagesAndGoesOn) {
  const int wire = robot->simPorts()[0]->descriptor();
  write(numbered(1));
  ASSERT_EQ(::send(wire, "odd", 3, MSG_DONTWAIT), 3);
  write(numbered(2));
  drain();
  EXPECT_EQ(inboxes[0].malformed.load(), 1U);
  EXPECT_EQ(inboxes[0].dropped.load(), 0U);
  EXPECT_EQ(numbers(), (std::vector<int>{1, 2}));
}

TEST_F(CanIntakeTest, ABusThatIsGoneIsSeen) {
  EXPECT_EQ(inboxes[0].link.load(), CanLinkState::kUp);
  robot->simPorts()[0].reset();
  drain();
  EXPECT_EQ(inboxes[0].link.load(), CanLinkState::kGone);
  write(numbered(7), 1);
  drain();
  EXPECT_EQ(numbers(1), std::vector<int>{7});
}

TEST_F(CanIntakeTest, TakesFramesOfANewSocketUnderTheOldNumber) {
  const SocketPair fresh;
  ASSERT_GE(::dup3(fresh.near.get(), robot->buses()[0].bus->descriptor(), O_CLOEXEC), 0);
  fresh.write(numbered(1));
  drain();
  EXPECT_EQ(numbers(), std::vector<int>{1});
}

TEST_F(CanIntakeTest, TheEchoSocketConfirmsAndGivesNoFrames) {
  SocketPair echo;
  robot->buses()[0].echo = std::move(echo.near);
  intake.emplace(*robot, inboxes, monotonicNow());
  EXPECT_EQ(inboxes[0].echo_reads.load(), 1U) << "there is one";
  EXPECT_EQ(inboxes[1].echo_reads.load(), 0U);
  frameCalls().received = [n = 0](msghdr& message) mutable {
    if (n++ < 2) message.msg_flags |= MSG_DONTROUTE;  // sent by this computer
  };
  for (std::uint8_t i = 0; i < 3; ++i) echo.write(numbered(i));
  drain();
  EXPECT_EQ(inboxes[0].confirmed.load(), 2U);
  EXPECT_EQ(inboxes[0].echo_reads.load(), 2U);
  EXPECT_TRUE(numbers().empty());
}

}  // namespace
}  // namespace rc10::test::can_intake_test
