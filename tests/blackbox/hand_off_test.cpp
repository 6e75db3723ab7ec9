#include "blackbox/hand_off.hpp"

#include <gtest/gtest.h>

#include "blackbox/memory_box.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::hand_off_test {
namespace {

TEST(HandOff, WhatIsWrittenIsReadInTheSameOrder) {
  MemoryBox box;
  auto out = box.handOff();
  for (std::uint64_t i = 0; i < 100; ++i) {
    auto frame = numberedFrame(i);
    EXPECT_TRUE(out.write(frame, kNumberedFrameBytes));
  }
  const auto recording = box.recording();
  const auto frames = all<blackbox::Frame>(recording);
  ASSERT_EQ(frames.size(), 100U);
  for (std::uint64_t i = 0; i < 100; ++i) EXPECT_EQ(numberOf(frames[i]), i);
  EXPECT_EQ(recording.damagedBytes(), 0U);
}

TEST(HandOff, AClassicFrameTakesThreeWords) {
  MemoryBox box;
  auto out = box.handOff();
  auto frame = numberedFrame(1);
  out.write(frame, kNumberedFrameBytes);
  EXPECT_EQ(box.head().control.head, 24U);
}

TEST(HandOff, AFullRingDropsTheNewestAndCounts) {
  MemoryBox box(4096);
  auto out = box.handOff();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    auto frame = numberedFrame(i);
    EXPECT_EQ(out.write(frame, kNumberedFrameBytes), i < 4096 / kNumberedFrameBytes);
  }
  EXPECT_EQ(box.head().control.dropped, 1000 - 4096 / kNumberedFrameBytes);
  EXPECT_EQ(numberOf(all<blackbox::Frame>(box.recording()).back()), 4096 / kNumberedFrameBytes - 1);
}

TEST(HandOff, GoesOnAfterTheReaderHasMadeRoomAndWrapsWithinARecord) {
  MemoryBox box(4096);
  auto out = box.handOff();
  std::uint64_t number = 0;
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 100; ++i) {
      auto frame = numberedFrame(number++);
      ASSERT_TRUE(out.write(frame, kNumberedFrameBytes));
    }
    const auto frames = all<blackbox::Frame>(box.recording());
    ASSERT_EQ(frames.size(), 100U);
    EXPECT_EQ(numberOf(frames.front()), number - 100);
    EXPECT_EQ(numberOf(frames.back()), number - 1);
    box.head().control.tail = box.head().control.head;
    box.head().control.oldest = box.head().control.head;
  }
  EXPECT_EQ(box.head().control.dropped, 0U);
}

TEST(HandOff, AllocatesNothing) {
  MemoryBox box(4096);
  auto out = box.handOff();
  const AllocGuard guard;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    auto frame = numberedFrame(i);
    out.write(frame);
  }
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST(Format, LengthCodesAreThoseOfCan) {
  constexpr std::array<std::size_t, 16> kLengths{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  for (std::size_t code = 0; code < kLengths.size(); ++code) {
    EXPECT_EQ(blackbox::lengthCode(kLengths[code]), code);
    const auto flags = static_cast<std::uint8_t>(code);
    EXPECT_EQ(blackbox::payloadBytes(static_cast<std::uint8_t>(flags | blackbox::kFrameFd)), kLengths[code]);
    EXPECT_EQ(blackbox::payloadBytes(flags), std::min<std::size_t>(kLengths[code], 8));
  }
}

}  // namespace
}  // namespace rc10::test::hand_off_test
