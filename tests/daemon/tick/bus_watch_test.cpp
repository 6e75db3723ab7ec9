// Buses that do not carry frames, and strangers on a bus: what leaves, and what is told.
#include "daemon/tick/bus_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <vector>

#include "bus/wire_frame.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::bus_watch_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kElbow = 3;
const Target kCurrent{.mode = ControlMode::kCurrent, .value = 1.0};

RobotConfig chassisAndArm() {
  auto config = twoWheelsAndYaw();
  auto arm = config.buses[0];
  arm.name = "arm";
  arm.motors = {makeMotor("elbow", kM2006, 1)};
  config.buses.push_back(std::move(arm));
  return config;
}

bool isRest(const CanFrame& frame) {
  return std::all_of(frame.data.begin(), frame.data.end(), [](std::uint8_t byte) { return byte == 0; });
}

/// Two buses; the first has an echo, which the test can take away. Somebody commands 1 A in every tick.
class BusWatchTest : public ::testing::Test {
 protected:
  BusWatchTest() {
    robot.inboxes()[0].echo_reads = 1;
    run(10);
    const auto result = robot.order(Operation::kEnable);
    EXPECT_EQ(result.motors[kLeft], Refusal::kNone);
    EXPECT_EQ(result.motors[kElbow], Refusal::kNone);
    run(10);
    (void)robot.events();
  }

  void tick() {
    robot.command(kLeft, kCurrent);
    robot.command(kElbow, kCurrent);
    robot.tick();
    if (echoes) robot.inboxes()[0].confirmed = counters().tx_watched;
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  /// Runs, and takes the first bus's frames off the wire before its drives see them.
  std::vector<CanFrame> sentIn(int ticks) {
    std::vector<CanFrame> frames;
    for (int i = 0; i < ticks; ++i) {
      tick();
      canfd_frame wire;
      for (;;) {
        const auto size = ::recv(robot.robot().simPorts()[0]->descriptor(), &wire, sizeof wire, MSG_DONTWAIT);
        if (size <= 0) break;
        CanFrame frame;
        EXPECT_TRUE(decodeFrame(wire, static_cast<std::size_t>(size), frame));
        frames.push_back(frame);
      }
    }
    return frames;
  }
  void dispatchError(std::uint32_t classes) {
    CanFrame frame = makeClassicFrame({}, std::array<std::uint8_t, 8>{});
    frame.type = FrameType::kError;
    frame.id = {classes, false};
    ASSERT_TRUE(robot.inboxes()[0].frames.push(frame));
  }
  void receiveFrom(CanId id, bool sent_here) {
    CanFrame frame = makeClassicFrame(id, std::array<std::uint8_t, 8>{1});
    frame.sent_here = sent_here;
    ASSERT_TRUE(robot.inboxes()[0].frames.push(frame));
  }
  std::vector<Event> foreign() {
    auto events = robot.events();
    std::erase_if(events, [](const Event& e) { return e.code != EventCode::kForeignSender; });
    return events;
  }
  BusState state(std::size_t bus = 0) { return robot.snapshot().buses[bus].state; }
  const BusCounters& counters(std::size_t bus = 0) { return robot.snapshot().buses[bus].counters; }
  MotorStatus status(std::size_t motor) { return robot.motor(motor).status; }

  bool echoes = true;
  VirtualRobot robot{chassisAndArm()};
};

TEST_F(BusWatchTest, WithoutEchoForFiveTicksTheBusIsStalledAndItsMotorsAreOffline) {
  echoes = false;
  run(5);
  EXPECT_EQ(state(), BusState::kActive);
  run(2);
  EXPECT_EQ(state(), BusState::kStalled);
  tick();
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline)
      << "although it still talks: what it does is not in our hands";
  EXPECT_EQ(robot.inboxes()[0].state.load(), BusState::kStalled);
}

TEST_F(BusWatchTest, TheOtherBusKeepsEveryTick) {
  echoes = false;
  const auto before = counters(1).tx_frames;
  run(1000);
  EXPECT_EQ(counters(1).tx_frames, before + 1000);
  EXPECT_EQ(status(kElbow), MotorStatus::kActive);
  EXPECT_NE(robot.motor(kElbow).command_value, 0.0F);
}

TEST_F(BusWatchTest, AStalledBusGetsNothingButARestFrameOfEachIdEvery50Milliseconds) {
  echoes = false;
  run(10);
  const auto held = counters().tx_held;
  const auto frames = sentIn(1000);
  EXPECT_TRUE(std::all_of(frames.begin(), frames.end(), isRest));
  EXPECT_EQ(frames.size(), 40U);
  EXPECT_EQ(counters().tx_held, held + 2000);
}

TEST_F(BusWatchTest, WhenAStalledBusRevivesRestLeavesFirstAndTheMotorsMustBeEnabledAgain) {
  echoes = false;
  run(200);
  echoes = true;
  const auto frames = sentIn(500);  // commanded all the time
  ASSERT_GT(frames.size(), 800U);
  EXPECT_TRUE(std::all_of(frames.begin(), frames.end(), isRest));
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  (void)robot.order(Operation::kEnable);
  run(2);
  EXPECT_NE(robot.motor(kLeft).command_value, 0.0F);
}

TEST_F(BusWatchTest, NothingIsHandedToAControllerThatIsBusOff) {
  dispatchError(CAN_ERR_BUSOFF);
  const auto frames = sentIn(1000);
  EXPECT_TRUE(frames.empty()) << "not even in the tick that learns of it";
  EXPECT_EQ(state(), BusState::kBusOff);
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  dispatchError(CAN_ERR_RESTARTED);
  const auto after = sentIn(100);
  EXPECT_EQ(after.size(), 200U);
  EXPECT_TRUE(std::all_of(after.begin(), after.end(), isRest));
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
}

TEST_F(BusWatchTest, ADriverThatSaysTheControllerRunsEndsBusOff) {
  dispatchError(CAN_ERR_BUSOFF);
  run(10);
  robot.inboxes()[0].controller_running.fetch_add(1);
  run(2);
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(robot.snapshot().buses[0].restarts, 1U);
}

TEST_F(BusWatchTest, AnInterfaceThatIsDownOrGoneIsNotWrittenTo) {
  for (const auto link : {CanLinkState::kDown, CanLinkState::kGone}) {
    robot.inboxes()[0].link = link;
    tick();  // the tick that finds it out
    EXPECT_TRUE(sentIn(200).size() <= 2U);
    robot.inboxes()[0].link = CanLinkState::kUp;
    const auto frames = sentIn(50);
    EXPECT_GT(frames.size(), 90U);
    EXPECT_TRUE(std::all_of(frames.begin(), frames.end(), isRest));
  }
}

TEST_F(BusWatchTest, APauseOfTheComputerIsNoStall) {
  echoes = false;
  robot.tick(300);
  echoes = true;
  run(10);
  const auto events = robot.events();
  EXPECT_TRUE(std::none_of(events.begin(), events.end(), [](const Event& e) {
    return e.code == EventCode::kBusState && e.value == static_cast<int>(BusState::kStalled);
  }));
}

TEST_F(BusWatchTest, AStopTriesRestInEveryTickAlsoOnAHeldBus) {
  echoes = false;
  run(20);
  robot.scheduler().beginStop();
  const auto frames = sentIn(10);
  EXPECT_EQ(frames.size(), 20U);
  EXPECT_TRUE(std::all_of(frames.begin(), frames.end(), isRest));
}

TEST_F(BusWatchTest, AHeldBusAllocatesNothing) {
  echoes = false;
  run(20);
  const AllocGuard guard;
  run(200);
  echoes = true;
  run(200);
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(BusWatchTest, AForeignSenderIsReportedWithItsIdAndWhereItIs) {
  receiveFrom({0x200, false}, false);
  tick();
  auto events = foreign();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].source, 0);
  EXPECT_EQ(counters().rx_foreign, 1U);
  EXPECT_THAT(describe(events[0]), HasSubstr("1 frames with our command id (0x200) from another node"));
  run(1000);
  receiveFrom({0x2FE, false}, true);
  tick();
  events = foreign();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_THAT(describe(events[0]), HasSubstr("(0x2FE) from another program on this computer"));
}

TEST_F(BusWatchTest, RestOfTheGuardIsNoSecondControllersUnlessItGoesOnAndOn) {
  CanFrame rest = makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{});
  rest.sent_here = true;
  const auto receive = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      rest.received = robot.now();
      ASSERT_TRUE(robot.inboxes()[0].frames.push(rest));
      tick();
    }
  };
  receive(60);
  EXPECT_TRUE(foreign().empty());
  EXPECT_EQ(counters().rx_foreign, 0U);
  receive(60);
  EXPECT_FALSE(foreign().empty()) << "a program that commands 0";
  run(2200);
  (void)foreign();
  rest.sent_here = false;
  receive(1);
  EXPECT_EQ(foreign().size(), 1U) << "another controller that commands 0";
}

TEST_F(BusWatchTest, ForeignFramesAreReportedOnceASecondAndAllAreCounted) {
  for (int i = 0; i < 2500; ++i) {
    receiveFrom({0x200, false}, false);
    tick();
  }
  const auto events = foreign();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1].value, 1000);
  EXPECT_EQ(counters().rx_foreign, 2500U);
}

TEST_F(BusWatchTest, FramesOfOtherIdsAreNoForeignCommands) {
  receiveFrom({0x300, false}, false);
  receiveFrom({0x200, true}, false);  // an extended id of the same number
  tick();
  EXPECT_TRUE(foreign().empty());
  EXPECT_EQ(counters().rx_foreign, 0U);
}

}  // namespace
}  // namespace rc10::test::bus_watch_test
