#include "daemon/devices/serial_channel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "bus/wire_frame.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/interfaces/can_intake.hpp"
#include "daemon/serial_rig.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::serial_channel_test {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Ge;

class SerialLineTest : public ::testing::Test, protected SerialRig {
 protected:
  SerialLineTest() {
    plugIn();
    check();
  }
};

TEST_F(SerialLineTest, BytesReachTheProtocolInTheirOrderAndWithATime) {
  std::vector<std::uint8_t> sent;
  const auto before = monotonicNow();
  for (int i = 0; i < 3000; ++i) sent.push_back(static_cast<std::uint8_t>(i * 7));
  for (std::size_t at = 0; at < sent.size(); at += 500) {
    pty->send(std::span(sent).subspan(at, 500));
    ASSERT_TRUE(pump([&] { return protocol.bytes.size() == at + 500; }));
  }
  EXPECT_EQ(protocol.bytes, sent);
  EXPECT_THAT(protocol.times, Each(Ge(before)));
  EXPECT_TRUE(std::is_sorted(protocol.times.begin(), protocol.times.end()));
  EXPECT_EQ(device.counters().bytes_in, 3000U);
  EXPECT_EQ(device.counters().chunks, protocol.times.size());
}

TEST_F(SerialLineTest, AFullRingDropsAndCounts) {
  while (channel.chunks.push(SerialChunk{})) {
  }
  pty->send({1, 2, 3});
  for (int i = 0; i < 200 && channel.dropped_chunks.load() == 0; ++i) rx->poll(std::chrono::milliseconds{50});
  deliver(channel, device);
  EXPECT_EQ(device.counters().dropped_chunks, channel.dropped_chunks.load());
  EXPECT_GE(device.counters().dropped_chunks, 1U);
}

TEST_F(SerialLineTest, DeliversWhatIsThereNow) {
  SerialChunk chunk;
  chunk.size = 1;
  for (std::uint8_t i = 1; i <= 3; ++i) {
    chunk.data[0] = i;
    channel.chunks.push(chunk);
  }
  deliver(channel, device);
  EXPECT_THAT(protocol.bytes, ElementsAre(1, 2, 3));
  EXPECT_EQ(channel.chunks.read_available(), 0U);
}

TEST_F(SerialLineTest, NothingOnTheWayAllocates) {
  std::vector<std::uint8_t> sent(100, 0x55);
  protocol.times.reserve(1000);
  const AllocGuard guard;
  for (int i = 0; i < 50; ++i) {
    pty->send(sent);
    rx->poll(std::chrono::milliseconds{50});
    deliver(channel, device);
    (void)device.send(sent);
    writer.flush();
  }
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(SerialLineTest, BusesAreReceivedBesidePorts) {
  pty->send({1});
  const CanFrame frame = makeClassicFrame({0x201, false}, std::array<std::uint8_t, 1>{1});
  canfd_frame wire;
  const auto size = encodeFrame(frame, wire);
  ASSERT_GT(::send(robot->simPorts()[0]->descriptor(), &wire, size, MSG_DONTWAIT), 0);
  CanIntake intake{*robot, inboxes, monotonicNow()};
  rx = RxLoop::create(channels.get(), RxLoop::Drain{intake, TimeGrid{std::chrono::milliseconds{1}}}).value();
  ASSERT_TRUE(rx->watchSerial(0));
  for (int i = 0; i < 1000 && (protocol.bytes.empty() || inboxes[0].frames.empty()); ++i) {
    rx->poll(rx->turn(monotonicNow()) - monotonicNow());
    deliver(channel, device);
  }
  EXPECT_THAT(protocol.bytes, ElementsAre(1));
  EXPECT_EQ(inboxes[0].frames.read_available(), 1U);
}

TEST(SerialOutbox, TakesAllOrNothing) {
  const auto channels =
      SerialChannels::create(std::vector<SerialChannel::Settings>{{"imu", "/dev/none"}}).value();
  auto& outbox = (*channels)[0].outbox;
  const std::vector<std::uint8_t> most(SerialOutbox::kBytes, 1);
  EXPECT_TRUE(outbox.push(std::span(most).first(SerialOutbox::kBytes - 2)));
  EXPECT_FALSE(outbox.push(std::span(most).first(3)));
  EXPECT_TRUE(outbox.push(std::span(most).first(2)));
  std::array<std::uint8_t, 10> out{};
  EXPECT_EQ(outbox.pop(out), 10U);
}

}  // namespace
}  // namespace rc10::test::serial_channel_test
