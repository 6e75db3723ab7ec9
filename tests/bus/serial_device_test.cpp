#include "bus/serial_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "support/alloc_guard.hpp"

namespace rc10::test::serial_device_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Collects bytes; a frame is the payload between two 0xAA.
class EchoProtocol final : public I_Protocol {
 public:
  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override {
    for (const auto byte : bytes) seen[count++ % seen.size()] = byte;
    last = received;
  }
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override {
    if (payload.empty() || payload.size() + 2 > out.size()) return 0;
    out[0] = out[payload.size() + 1] = 0xAA;
    std::copy(payload.begin(), payload.end(), out.begin() + 1);
    return payload.size() + 2;
  }
  void restart() noexcept override { ++restarts; }

  std::array<std::uint8_t, 64> seen{};
  std::size_t count = 0;
  int restarts = 0;
  MonotonicTime last;
};

class Outbox final : public ByteSink {
 public:
  Outbox() { bytes.reserve(1024); }
  bool push(std::span<const std::uint8_t> more) noexcept override {
    if (full) return false;
    bytes.insert(bytes.end(), more.begin(), more.end());
    return true;
  }
  [[nodiscard]] std::size_t pending() const noexcept override { return bytes.size(); }
  std::vector<std::uint8_t> bytes;
  bool full = false;
};

class SerialDeviceTest : public ::testing::Test {
 protected:
  static SerialChunk chunk(std::initializer_list<std::uint8_t> bytes, Duration at,
                           std::uint32_t opening = 1) {
    SerialChunk made;
    made.received = MonotonicTime{at};
    made.opening = opening;
    made.size = static_cast<std::uint16_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), made.data.begin());
    return made;
  }

  Outbox outbox;
  SerialDevice device{"imu", std::make_unique<EchoProtocol>(), outbox};
  EchoProtocol& protocol = static_cast<EchoProtocol&>(device.protocol());
};

TEST_F(SerialDeviceTest, GivesBytesToItsProtocolWithTheirTime) {
  device.receive(chunk({1, 2, 3}, 5s));
  device.receive(chunk({4}, 6s));
  EXPECT_EQ(protocol.count, 4U);
  EXPECT_EQ(protocol.seen[3], 4);
  EXPECT_EQ(protocol.last, MonotonicTime{6s});
  EXPECT_EQ(device.counters().bytes_in, 4U);
  EXPECT_EQ(device.counters().chunks, 2U);
  EXPECT_EQ(device.name(), "imu");
}

TEST_F(SerialDeviceTest, KnowsHowLongNothingHasCome) {
  EXPECT_EQ(device.age(MonotonicTime{10s}), Duration::max());
  device.receive(chunk({1}, 7s));
  EXPECT_EQ(device.lastReceived(), MonotonicTime{7s});
  EXPECT_EQ(device.age(MonotonicTime{10s}), 3s);
}

TEST_F(SerialDeviceTest, BytesOfTwoOpeningsAreNotJoined) {
  device.receive(chunk({1}, 1s, 1));
  device.receive(chunk({2}, 2s, 1));
  EXPECT_EQ(protocol.restarts, 1);
  device.receive(chunk({3}, 3s, 2));
  EXPECT_EQ(protocol.restarts, 2);
}

TEST_F(SerialDeviceTest, SendsFramesWhileItIsOpen) {
  device.setState(SerialState::kOpen);
  const std::array<std::uint8_t, 2> payload{7, 8};
  EXPECT_TRUE(device.sendFrame(payload));
  EXPECT_TRUE(device.send(payload));
  EXPECT_THAT(outbox.bytes, ElementsAre(0xAA, 7, 8, 0xAA, 7, 8));
  EXPECT_EQ(device.counters().bytes_out, 6U);
  EXPECT_EQ(device.counters().refused_bytes, 0U);
}

TEST_F(SerialDeviceTest, CountsWhatItCannotSend) {
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  EXPECT_FALSE(device.send(bytes)) << "absent";
  device.setState(SerialState::kOpen);
  outbox.full = true;
  EXPECT_FALSE(device.send(bytes));
  EXPECT_EQ(device.counters().refused_bytes, 6U);
  EXPECT_EQ(device.counters().bytes_out, 0U);
  EXPECT_FALSE(device.sendFrame({})) << "the protocol has no such frame";
  EXPECT_EQ(device.counters().refused_bytes, 6U);
  EXPECT_THAT(outbox.bytes, IsEmpty());
}

TEST_F(SerialDeviceTest, AllocatesNothing) {
  device.setState(SerialState::kOpen);
  const std::array<std::uint8_t, 2> payload{7, 8};
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) {
    device.receive(chunk({1, 2, 3}, 1s));
    (void)device.sendFrame(payload);
  }
  EXPECT_EQ(guard.allocations(), 0U);
}

}  // namespace
}  // namespace rc10::test::serial_device_test
