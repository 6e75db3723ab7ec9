#include "module/dbus_protocol.hpp"

#include <gtest/gtest.h>

#include "module/serial_streams.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::dbus_protocol_test {
namespace {

using namespace std::chrono_literals;
using Switch = Dr16Input::Switch;

// RoboMaster Development-Board-C-Examples, remote_control.c; computed independently.
const Bytes kGolden = hex("00 64 0B A5 01 78 FB FF 0A 00 00 00 01 00 11 00 00 04");
const Dr16Input kGoldenInput{.right_horizontal = 0,
                             .right_vertical = -660,
                             .left_horizontal = 660,
                             .left_vertical = 0,
                             .wheel = 0,
                             .right_switch = Switch::kMiddle,
                             .left_switch = Switch::kUp,
                             .mouse_x = -5,
                             .mouse_y = 10,
                             .mouse_z = 0,
                             .mouse_left = true,
                             .mouse_right = false,
                             .keys = 0x0011};  // W and Shift

Bytes encoded(const Dr16Input& input) {
  const auto frame = DbusProtocol::encode(input);
  return {frame.begin(), frame.end()};
}

Dr16Input anyInput(std::mt19937& random) {
  const auto stick = [&] {
    return static_cast<std::int16_t>(static_cast<int>(random() % 1321) - Dr16Input::kFullDeflection);
  };
  const auto any_switch = [&] { return static_cast<Switch>(1 + random() % 3); };
  return {stick(),
          stick(),
          stick(),
          stick(),
          stick(),
          any_switch(),
          any_switch(),
          static_cast<std::int16_t>(random()),
          static_cast<std::int16_t>(random()),
          static_cast<std::int16_t>(random()),
          random() % 2 == 0,
          random() % 2 == 0,
          static_cast<std::uint16_t>(random())};
}

// A receiver that is heard from its first byte on: one frame has shown where frames begin.
class DbusProtocolTest : public ::testing::Test {
 protected:
  DbusProtocolTest() { feed(protocol, encoded({}), now); }

  void afterSilence(const Bytes& bytes) { feed(protocol, bytes, now += 12ms); }
  void atOnce(const Bytes& bytes) { feed(protocol, bytes, now); }

  MonotonicTime now{1000s};
  DbusProtocol protocol;
};

TEST_F(DbusProtocolTest, DecodesTheGoldenFrame) {
  afterSilence(kGolden);
  EXPECT_EQ(protocol.input().value, kGoldenInput);
  EXPECT_EQ(protocol.input().received, now);
  EXPECT_EQ(protocol.counters().frames, 1U);
}

TEST_F(DbusProtocolTest, EncodesTheGoldenFrame) { EXPECT_EQ(encoded(kGoldenInput), kGolden); }

TEST_F(DbusProtocolTest, WhatIsEncodedIsDecoded) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto input = anyInput(random);
    afterSilence(encoded(input));
    ASSERT_EQ(protocol.input().value, input);
  }
  EXPECT_EQ(protocol.counters().frames, 1000U);
}

TEST_F(DbusProtocolTest, TheFirstFrameEverOnlyShowsWhereFramesBegin) {
  EXPECT_EQ(protocol.counters().frames, 0U);
  EXPECT_EQ(protocol.input().age(now), Duration::max());
  atOnce(kGolden);
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.input().age(now + 5ms), 5ms);
}

TEST_F(DbusProtocolTest, FramesMayComeInPieces) {
  for (std::size_t cut = 1; cut < kGolden.size(); ++cut) {
    afterSilence({kGolden.begin(), kGolden.begin() + static_cast<std::ptrdiff_t>(cut)});
    now += 1ms;
    atOnce({kGolden.begin() + static_cast<std::ptrdiff_t>(cut), kGolden.end()});
    ASSERT_EQ(protocol.counters().frames, cut);
    ASSERT_EQ(protocol.input().received, now) << "the time of its last byte";
  }
}

TEST_F(DbusProtocolTest, ASilenceEndsAPartOfAFrame) {
  atOnce({kGolden.begin(), kGolden.begin() + 7});
  afterSilence(kGolden);
  EXPECT_EQ(protocol.input().value, kGoldenInput);
  EXPECT_EQ(protocol.counters().resync_bytes, 18U + 7U);
}

TEST_F(DbusProtocolTest, NoiseWithoutASilenceCostsOneFrame) {
  atOnce(joined({kGolden, noise(11, 1), kGolden, kGolden}));
  EXPECT_EQ(protocol.counters().frames, 2U);
  EXPECT_EQ(protocol.counters().resync_bytes, 18U + 11U + 18U);
}

TEST_F(DbusProtocolTest, NoiseIsNoFrame) {
  for (std::uint32_t seed = 0; seed < 3000; ++seed) afterSilence(noise(18, seed));
  EXPECT_EQ(protocol.counters().frames, 0U);
}

TEST_F(DbusProtocolTest, AFrameWithAByteTooFewOrTooManyIsNotBelieved) {
  for (std::size_t missing = 0; missing < 18; ++missing) {
    auto cut = kGolden;
    cut.erase(cut.begin() + static_cast<std::ptrdiff_t>(missing));
    afterSilence(cut);
  }
  EXPECT_EQ(protocol.counters().frames, 0U);
  afterSilence(joined({kGolden, {0x00}}));
  EXPECT_EQ(protocol.counters().frames, 1U);
}

TEST_F(DbusProtocolTest, FieldsOutOfTheirRangesAreNoFrame) {
  struct Case {
    std::size_t byte;
    std::uint8_t value;
    const char* what;
  };
  for (const auto& [byte, value, what] :
       {Case{1, 0x00, "right horizontal below 364"}, Case{1, 0x07, "right horizontal above 1684"},
        Case{5, 0x04, "no right switch"}, Case{5, 0x10, "no left switch"}, Case{12, 2, "left button"},
        Case{13, 0xFF, "right button"}, Case{17, 0x07, "wheel above"}, Case{17, 0x01, "wheel below"}}) {
    auto frame = encoded({});
    frame[byte] = value;
    afterSilence(frame);
    EXPECT_EQ(protocol.counters().frames, 0U) << what;
  }
}

TEST_F(DbusProtocolTest, AnOldRemoteHasNoWheel) {
  auto frame = kGolden;
  frame[16] = frame[17] = 0;
  afterSilence(frame);
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.input().value.wheel, 0);
}

// Heard from the middle of a frame on, and through an adapter that hides every silence.
TEST(DbusProtocol, FindsTheFramesOfAnEndlessStreamFromAnyByte) {
  std::mt19937 random(3);
  for (int run = 0; run < 200; ++run) {
    Bytes stream;
    std::vector<Dr16Input> sent;
    for (int i = 0; i < 6; ++i) {
      sent.push_back(anyInput(random));
      sent.back().mouse_x = sent.back().mouse_y = sent.back().mouse_z = 0;
      const auto frame = encoded(sent.back());
      stream.insert(stream.end(), frame.begin(), frame.end());
    }
    DbusProtocol protocol;
    const auto begin = random() % 18;
    feed(protocol, stream.data() + begin, stream.size() - begin, {});
    EXPECT_EQ(protocol.input().value, sent.back()) << "run " << run;
  }
}

TEST(DbusProtocol, EverySplitGivesTheSame) {
  const auto stream =
      joined({kGolden, kGolden, noise(25, 4), kGolden, kGolden, noise(3, 5), kGolden, kGolden});
  expectTheSameForEverySplit(
      stream, [] { return std::make_unique<DbusProtocol>(); },
      [](const DbusProtocol& p) { return p.input().samples; });
}

TEST(DbusProtocol, ANewOpeningForgetsThePartOfAFrame) {
  DbusProtocol protocol;
  feed(protocol, joined({kGolden, kGolden}));
  feed(protocol, Bytes(kGolden.begin(), kGolden.begin() + 9));
  protocol.restart();
  feed(protocol, joined({kGolden, kGolden}));
  EXPECT_EQ(protocol.counters().frames, 2U);
}

TEST(DbusProtocol, HasNoCommands) {
  DbusProtocol protocol;
  Bytes out(64);
  EXPECT_EQ(protocol.pack_frame(kGolden, out), 0U);
}

TEST(DbusProtocol, AllocatesNothing) {
  DbusProtocol protocol;
  const auto stream = joined({kGolden, noise(50, 6), kGolden});
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) protocol.parse_stream(stream, MonotonicTime{i * 14ms});
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GE(protocol.counters().frames, 50U) << "it had work";
}

}  // namespace
}  // namespace rc10::test::dbus_protocol_test
