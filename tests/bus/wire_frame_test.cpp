#include "bus/wire_frame.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <numeric>

namespace rc10::test::wire_frame_test {
namespace {

std::array<std::uint8_t, kMaxPayload> countingBytes() {
  std::array<std::uint8_t, kMaxPayload> bytes{};
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

CanFrame frameOf(CanId id, std::size_t length, bool fd = false) {
  const auto bytes = countingBytes();
  const auto payload = std::span(bytes).first(length);
  return fd ? makeFdFrame(id, payload, true) : makeClassicFrame(id, payload);
}

// Earlier bytes of the stack must not reach the wire.
canfd_frame garbage() {
  canfd_frame wire{};
  std::memset(&wire, 0xA5, sizeof(wire));
  return wire;
}

void expectSame(const CanFrame& a, const CanFrame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.fd, b.fd);
  EXPECT_EQ(a.bit_rate_switch, b.bit_rate_switch);
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.data, b.data);
}

TEST(WireFrame, AClassicFrameIsTheKernelsCanFrame) {
  canfd_frame wire = garbage();
  ASSERT_EQ(encodeFrame(frameOf({0x201, false}, 5), wire), 16U);
  can_frame classic{};
  std::memcpy(&classic, &wire, sizeof(classic));
  EXPECT_EQ(classic.can_id, 0x201U);
  EXPECT_EQ(classic.len, 5);
  EXPECT_EQ(classic.data[4], 5);
  EXPECT_EQ(classic.data[5], 0);
}

TEST(WireFrame, WritesEveryByte) {
  canfd_frame wire = garbage();
  ASSERT_NE(encodeFrame(frameOf({0x201, false}, 2), wire), 0U);
  canfd_frame expected{};
  expected.can_id = 0x201;
  expected.len = 2;
  expected.data[0] = 1;
  expected.data[1] = 2;
  EXPECT_EQ(std::memcmp(&wire, &expected, sizeof(wire)), 0);
}

TEST(WireFrame, AnExtendedIdHasItsFlag) {
  canfd_frame wire = garbage();
  ASSERT_EQ(encodeFrame(frameOf({0x201, true}, 8), wire), 16U);
  EXPECT_EQ(wire.can_id, 0x201U | CAN_EFF_FLAG);
}

TEST(WireFrame, EveryDataFrameSurvivesTheRoundTrip) {
  for (const bool extended : {false, true}) {
    for (const bool fd : {false, true}) {
      for (std::size_t length = 0; length <= (fd ? 64U : 8U); ++length) {
        const CanFrame sent = frameOf({0x123, extended}, length, fd);
        canfd_frame wire = garbage();
        const std::size_t size = encodeFrame(sent, wire);
        ASSERT_EQ(size, fd ? 72U : 16U);
        CanFrame received;
        ASSERT_TRUE(decodeFrame(wire, size, received));
        expectSame(sent, received);
      }
    }
  }
}

TEST(WireFrame, ARemoteFrameKeepsItsLengthAndHasNoPayload) {
  CanFrame sent = frameOf({0x123, true}, 8);
  sent.type = FrameType::kRemote;
  canfd_frame wire = garbage();
  ASSERT_EQ(encodeFrame(sent, wire), 16U);
  EXPECT_EQ(wire.can_id, 0x123U | CAN_EFF_FLAG | CAN_RTR_FLAG);
  CanFrame received;
  ASSERT_TRUE(decodeFrame(wire, 16, received));
  EXPECT_EQ(received.type, FrameType::kRemote);
  EXPECT_EQ(received.length, 8);
  EXPECT_EQ(received.data[0], 0);
}

TEST(WireFrame, AnErrorMessageKeepsItsClasses) {
  CanFrame sent = frameOf({0x2000'0000 - 1, false}, 8);
  sent.type = FrameType::kError;
  canfd_frame wire = garbage();
  ASSERT_EQ(encodeFrame(sent, wire), 16U);
  EXPECT_EQ(wire.can_id, CAN_ERR_FLAG | CAN_ERR_MASK);
  CanFrame received;
  ASSERT_TRUE(decodeFrame(wire, 16, received));
  expectSame(sent, received);
}

TEST(WireFrame, DoesNotEncodeWhatCannotExist) {
  canfd_frame wire{};
  EXPECT_EQ(encodeFrame(frameOf({0x800, false}, 8), wire), 0U);
  EXPECT_EQ(encodeFrame(frameOf({0x2000'0000, true}, 8), wire), 0U);
  CanFrame too_long = frameOf({1, false}, 8);
  too_long.length = 9;
  EXPECT_EQ(encodeFrame(too_long, wire), 0U);
  CanFrame between_lengths = frameOf({1, false}, 12, true);
  between_lengths.length = 13;
  EXPECT_EQ(encodeFrame(between_lengths, wire), 0U);
  CanFrame remote_fd = frameOf({1, false}, 8, true);
  remote_fd.type = FrameType::kRemote;
  EXPECT_EQ(encodeFrame(remote_fd, wire), 0U);
}

TEST(WireFrame, DoesNotDecodeWhatIsNoFrame) {
  canfd_frame wire{};
  CanFrame untouched = frameOf({0x7, false}, 3);
  for (const std::size_t size : {1U, 15U, 17U, 71U, 73U}) EXPECT_FALSE(decodeFrame(wire, size, untouched));
  wire.len = 9;
  EXPECT_FALSE(decodeFrame(wire, 16, untouched));
  EXPECT_FALSE(decodeFrame(wire, 72, untouched));
  wire.len = 65;
  EXPECT_FALSE(decodeFrame(wire, 72, untouched));
  wire.len = 8;
  wire.can_id = CAN_RTR_FLAG | 1;
  EXPECT_FALSE(decodeFrame(wire, 72, untouched));
  wire.can_id = CAN_ERR_FLAG | 1;
  EXPECT_FALSE(decodeFrame(wire, 72, untouched));
  expectSame(untouched, frameOf({0x7, false}, 3));
}

TEST(WireFrame, BytesBehindThePayloadAreNotTaken) {
  canfd_frame wire = garbage();
  wire.can_id = 0x201;
  wire.len = 2;
  CanFrame received;
  ASSERT_TRUE(decodeFrame(wire, 16, received));
  EXPECT_EQ(received.data[1], 0xA5);
  EXPECT_EQ(received.data[2], 0);
}

}  // namespace
}  // namespace rc10::test::wire_frame_test
