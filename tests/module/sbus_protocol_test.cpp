#include "module/sbus_protocol.hpp"

#include <gtest/gtest.h>

#include "module/serial_streams.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::sbus_protocol_test {
namespace {

using namespace std::chrono_literals;

// Betaflight, sbus.c; computed independently: channel 1 at 173, 2 at 1812, the others at 992; failsafe.
const Bytes kGolden = hex("0F AD A0 38 F8 C0 07 3E F0 81 0F 7C E0 03 1F F8 C0 07 3E F0 81 0F 7C 08 00");

SbusInput goldenInput() {
  SbusInput input;
  input.raw.fill(SbusInput::kCentre);
  input.raw[0] = 173;
  input.raw[1] = 1812;
  input.failsafe = true;
  return input;
}

Bytes encoded(const SbusInput& input) {
  const auto frame = SbusProtocol::encode(input);
  return {frame.begin(), frame.end()};
}

SbusInput anyInput(std::mt19937& random) {
  SbusInput input;
  for (auto& channel : input.raw) channel = static_cast<std::uint16_t>(random() % 2048);
  input.digital = {random() % 2 == 0, random() % 2 == 0};
  input.frame_lost = random() % 2 == 0;
  input.failsafe = random() % 2 == 0;
  return input;
}

class SbusProtocolTest : public ::testing::Test {
 protected:
  SbusProtocolTest() { feed(protocol, encoded({}), now); }

  void afterSilence(const Bytes& bytes) { feed(protocol, bytes, now += 5ms); }

  MonotonicTime now{1000s};
  SbusProtocol protocol;
};

TEST_F(SbusProtocolTest, DecodesTheGoldenFrame) {
  afterSilence(kGolden);
  const auto& input = protocol.input().value;
  EXPECT_EQ(input, goldenInput());
  EXPECT_EQ(protocol.input().received, now);
  EXPECT_FLOAT_EQ(input.pulseUs(0), 988.125F);
  EXPECT_FLOAT_EQ(input.pulseUs(1), 2012.5F);
  EXPECT_FLOAT_EQ(input.pulseUs(2), 1500.0F);
}

TEST_F(SbusProtocolTest, EncodesTheGoldenFrame) { EXPECT_EQ(encoded(goldenInput()), kGolden); }

TEST_F(SbusProtocolTest, WhatIsEncodedIsDecoded) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto input = anyInput(random);
    afterSilence(encoded(input));
    ASSERT_EQ(protocol.input().value, input);
  }
}

TEST_F(SbusProtocolTest, TellsLostFramesFromALostRemote) {
  SbusInput input;
  input.frame_lost = true;
  afterSilence(encoded(input));
  EXPECT_TRUE(protocol.input().value.frame_lost);
  EXPECT_FALSE(protocol.input().value.failsafe);
  input = {};
  input.failsafe = true;
  afterSilence(encoded(input));
  EXPECT_FALSE(protocol.input().value.frame_lost);
  EXPECT_TRUE(protocol.input().value.failsafe);
}

TEST_F(SbusProtocolTest, ChannelsHaveAFullDeflectionOfOne) {
  SbusInput input;
  input.raw = {172, 992, 1812, 0, 2047, 1402};
  EXPECT_FLOAT_EQ(input.deflection(0), -1.0F);
  EXPECT_FLOAT_EQ(input.deflection(1), 0.0F);
  EXPECT_FLOAT_EQ(input.deflection(2), 1.0F);
  EXPECT_FLOAT_EQ(input.deflection(3), -1.0F);
  EXPECT_FLOAT_EQ(input.deflection(4), 1.0F);
  EXPECT_FLOAT_EQ(input.deflection(5), 0.5F);
}

TEST_F(SbusProtocolTest, TakesTheEndBytesOfSbus2) {
  for (const auto end : hex("00 04 14 24 34")) {
    auto frame = kGolden;
    frame[24] = end;
    afterSilence(frame);
  }
  EXPECT_EQ(protocol.counters().frames, 5U);
}

TEST_F(SbusProtocolTest, WrongHeaderEndOrUnusedBitsAreNoFrame) {
  struct Case {
    std::size_t byte;
    std::uint8_t value;
  };
  for (const auto& [byte, value] :
       {Case{0, 0x0E}, Case{23, 0x10}, Case{23, 0x88}, Case{24, 0x01}, Case{24, 0xFF}}) {
    auto frame = kGolden;
    frame[byte] = value;
    afterSilence(frame);
    EXPECT_EQ(protocol.counters().frames, 0U) << "byte " << byte;
  }
  afterSilence(kGolden);
  EXPECT_EQ(protocol.counters().frames, 1U);
}

TEST_F(SbusProtocolTest, AFalseBeginningLastsUntilTheNextSilence) {
  // Channels that look like header, flags and end in the middle of every frame.
  SbusInput tricky;
  auto frame = encoded(tricky);
  frame[10] = 0x0F;
  for (int i = 0; i < 3; ++i) {
    afterSilence(Bytes(frame.begin() + 10, frame.end()));
    afterSilence(frame);
  }
  EXPECT_EQ(protocol.counters().frames, 3U);
}

TEST_F(SbusProtocolTest, NoiseBeforeBetweenAndAfterIsSurvived) {
  feed(protocol, noise(40, 2), now);
  afterSilence(kGolden);
  feed(protocol, noise(10, 3), now);
  afterSilence(kGolden);
  feed(protocol, noise(100, 4), now);
  EXPECT_EQ(protocol.counters().frames, 2U);
  EXPECT_EQ(protocol.input().value, goldenInput());
}

TEST(SbusProtocol, EverySplitGivesTheSame) {
  const auto stream = joined({noise(7, 5), kGolden, kGolden, noise(30, 6), kGolden, kGolden, noise(9, 7)});
  expectTheSameForEverySplit(
      stream, [] { return std::make_unique<SbusProtocol>(); },
      [](const SbusProtocol& p) { return p.input().samples; });
}

TEST(SbusProtocol, AllocatesNothing) {
  SbusProtocol protocol;
  const auto stream = joined({kGolden, noise(50, 8), kGolden});
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) protocol.parse_stream(stream, MonotonicTime{i * 7ms});
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GE(protocol.counters().frames, 50U) << "it had work";
}

}  // namespace
}  // namespace rc10::test::sbus_protocol_test
