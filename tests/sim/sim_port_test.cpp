#include "sim/sim_port.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "bus/can_receiver.hpp"
#include "bus/send_batch.hpp"
#include "support/alloc_guard.hpp"

#include "drives/dji/dji_simulated.hpp"

namespace rc10::test::sim_port_test {
namespace {

using namespace std::chrono_literals;
using sim::SimBusConfig;
using sim::SimPort;
using sim::Stamps;

SimBusConfig twoWheels() {
  SimBusConfig config;
  config.drives = {sim::djiDrive({"left", &kM3508, 1, DjiCommand::kCurrent, 0.0, {}}),
                   sim::djiDrive({"right", &kM3508, 2, DjiCommand::kCurrent, 0.0, {}})};
  return config;
}

class SimPortTest : public testing::Test {
 protected:
  explicit SimPortTest(Stamps stamps = Stamps::kKernel) {
    auto ends = SimPort::makeSocketPair();
    near_ = std::move(ends->first);
    port_ = std::make_unique<SimPort>(std::move(ends->second), twoWheels(), stamps);
    port_->step(now_);
  }

  void step(Duration dt = 1ms) { port_->step(now_ += dt); }

  /// Bytes that the daemon's end has received since.
  std::vector<CanFrame> received() {
    CanReceiver receiver{near_.get()};
    const WakeUp wake{.now = now_, .previous = now_, .realtime_offset = {}, .previous_offset = {}};
    std::vector<CanFrame> frames;
    for (std::array<CanFrame, CanReceiver::kBatch> batch{};;) {
      const Reception reception = receiver.receive(wake, batch);
      EXPECT_EQ(reception.malformed_count, 0U);
      if (reception.frame_count == 0) return frames;
      frames.insert(frames.end(), batch.begin(),
                    batch.begin() + static_cast<std::ptrdiff_t>(reception.frame_count));
    }
  }

  void command(std::int16_t raw) {
    const auto high = static_cast<std::uint8_t>(static_cast<std::uint16_t>(raw) >> 8U);
    const auto low = static_cast<std::uint8_t>(static_cast<std::uint16_t>(raw) & 0xFFU);
    SendBatch batch;
    ASSERT_TRUE(
        batch.add(makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{high, low}), std::nullopt));
    ASSERT_EQ(batch.send(near_.get()), 1U);
  }

  UniqueFd near_;
  std::unique_ptr<SimPort> port_;
  MonotonicTime now_{100s};
};

TEST_F(SimPortTest, TheFirstStepOnlySetsTheClock) {
  EXPECT_TRUE(received().empty());
  EXPECT_EQ(port_->counters().sent, 0U);
}

TEST_F(SimPortTest, EveryMillisecondBringsOneFrameOfEachDrive) {
  for (int i = 0; i < 10; ++i) {
    step();
    const auto frames = received();
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].id, (CanId{0x201, false}));
    EXPECT_EQ(frames[1].id, (CanId{0x202, false}));
    EXPECT_EQ(frames[0].length, 8);
  }
  EXPECT_EQ(port_->counters().sent, 20U);
}

TEST_F(SimPortTest, CommandsReachTheDrives) {
  command(8192);  // 10 A on the left one
  for (int i = 0; i < 300; ++i) step();
  EXPECT_GT(port_->bus().motor(0).outputRpm(), 100.0);
  EXPECT_EQ(port_->bus().motor(1).outputRpm(), 0.0);
  EXPECT_EQ(port_->counters().commands, 1U);
}

TEST_F(SimPortTest, OfManyCommandsTheLastOneCounts) {
  for (std::int16_t i = 0; i < 150; ++i) command(i);
  step();
  EXPECT_EQ(port_->counters().commands, 150U);
  EXPECT_EQ(dynamic_cast<const sim::DjiDrive&>(port_->bus().drive(0)).rawCommand(), 149);
}

TEST_F(SimPortTest, ALateStepMovesTheMotorsButSpeaksOnce) {
  command(8192);
  step(40ms);
  EXPECT_EQ(received().size(), 2U);
  EXPECT_GT(port_->bus().motor(0).outputRpm(), 5.0);
  EXPECT_EQ(port_->bus().counters().overslept, 2U * 39U);
  step();
  EXPECT_EQ(received().size(), 2U);
}

TEST_F(SimPortTest, AfterALongStopTheMotorsGoOnFromWhereTheyWere) {
  command(8192);
  step(3600s);
  EXPECT_EQ(port_->counters().skipped, 3599s);
  step();
  EXPECT_EQ(received().size(), 4U);
}

TEST_F(SimPortTest, MotorsStandStillWhileTheirFramesAreHeldBack) {
  command(8192);
  for (int i = 0; i < 300; ++i) step();
  const double before_deg = port_->bus().motor(0).outputAngleDeg();
  port_->sentAt(now_ += 13ms);  // the kernel's stamp of the last frame
  step();
  // 1 ms between the stamps, and 1 ms of turning.
  const double rpm = port_->bus().motor(0).outputRpm();
  EXPECT_NEAR(port_->bus().motor(0).outputAngleDeg() - before_deg, rpm * 6.0 / 1000.0, 0.1);
  EXPECT_EQ(port_->counters().skipped, 13ms);
}

TEST_F(SimPortTest, SendingThatTakesItsUsualTimeSkipsNothing) {
  for (int i = 0; i < 10; ++i) {
    step();
    port_->sentAt(now_ + 2ms);
  }
  EXPECT_EQ(port_->counters().skipped, 0ms);
  EXPECT_EQ(port_->counters().sent, 20U);
}

class SimPortOfItsOwnTest : public SimPortTest {
 protected:
  SimPortOfItsOwnTest() : SimPortTest(Stamps::kOwn) {}
};

TEST_F(SimPortOfItsOwnTest, ALateStepIsMadeUpForMillisecondByMillisecond) {
  command(8192);
  step();
  (void)received();
  auto late = now_;
  step(50ms);
  const auto frames = received();
  ASSERT_EQ(frames.size(), 2U * 50U);
  for (std::size_t i = 0; i < frames.size(); i += 2) {
    EXPECT_EQ(frames[i].received, late += 1ms);
    EXPECT_EQ(frames[i + 1].received, late);
  }
  EXPECT_EQ(port_->bus().counters().overslept, 0U);
  EXPECT_EQ(port_->counters().skipped, 0ms);
}

TEST_F(SimPortOfItsOwnTest, ALateStepMovesTheMotorsAsPunctualOnesDo) {
  auto ends = SimPort::makeSocketPair();
  SimPort punctual{std::move(ends->second), twoWheels(), Stamps::kOwn};
  punctual.step(now_);
  SendBatch batch;
  ASSERT_TRUE(batch.add(makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{0x20}), std::nullopt));
  ASSERT_EQ(batch.send(ends->first.get()), 1U);
  for (auto at = now_ + 1ms; at <= now_ + 50ms; at += 1ms) punctual.step(at);
  command(0x2000);
  step(50ms);
  EXPECT_GT(port_->bus().motor(0).outputRpm(), 5.0);
  EXPECT_EQ(port_->bus().motor(0).outputAngleDeg(), punctual.bus().motor(0).outputAngleDeg());
}

TEST_F(SimPortOfItsOwnTest, AfterALongStopTheMotorsGoOnFromWhereTheyWere) {
  step(3600s);
  EXPECT_EQ(port_->counters().skipped, 3600s - SimPort::kLongestMadeUpFor);
  EXPECT_EQ(received().size(), 2U * 100U);
}

TEST_F(SimPortOfItsOwnTest, WhenItsFramesWereWrittenMakesNoDifference) {
  port_->sentAt(now_ + 13ms);
  step();
  EXPECT_EQ(port_->counters().skipped, 0ms);
  EXPECT_EQ(received().front().received, now_);
}

TEST_F(SimPortTest, TimeThatRunsBackwardsIsNoTime) {
  step(-50ms);
  EXPECT_EQ(port_->counters().sent, 0U);
  step(51ms);  // 1 ms after the latest
  EXPECT_EQ(port_->counters().sent, 2U);
  EXPECT_EQ(port_->bus().counters().overslept, 0U);
}

TEST_F(SimPortTest, FeedbackThatNobodyReadsIsDroppedAndCounted) {
  for (int i = 0; i < 5000; ++i) step();
  EXPECT_GT(port_->counters().refused, 0U);
  EXPECT_EQ(port_->counters().sent + port_->counters().refused, 10'000U);
  EXPECT_EQ(received().size(), port_->counters().sent);
  step();
  EXPECT_EQ(received().size(), 2U);
}

TEST_F(SimPortTest, MessagesThatAreNoFramesAreCounted) {
  const std::array<char, 5> junk{};
  ASSERT_EQ(::send(near_.get(), junk.data(), junk.size(), 0), 5);
  command(100);
  step();
  EXPECT_EQ(port_->counters().malformed, 1U);
  EXPECT_EQ(port_->counters().commands, 1U);
}

TEST_F(SimPortTest, SurvivesThatTheOtherEndIsClosed) {
  near_.reset();
  for (int i = 0; i < 10; ++i) step();
  EXPECT_EQ(port_->counters().refused, 20U);
  EXPECT_NE(port_->counters().error, 0);
}

TEST_F(SimPortTest, KernelStampsArriveLikeOnSocketCan) {
  step();
  std::array<std::byte, 64> data{};
  alignas(cmsghdr) std::array<std::byte, 128> control{};
  iovec content{data.data(), data.size()};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  ASSERT_EQ(::recvmsg(near_.get(), &message, MSG_DONTWAIT), 16);
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  ASSERT_NE(header, nullptr);
  EXPECT_EQ(header->cmsg_type, SCM_TIMESTAMPNS);
}

TEST_F(SimPortTest, SteppingAllocatesNothing) {
  command(1000);
  AllocGuard guard;
  for (int i = 0; i < 100; ++i) step();
  EXPECT_EQ(guard.allocations(), 0U);
}

}  // namespace
}  // namespace rc10::test::sim_port_test
