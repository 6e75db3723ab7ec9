#include "bus/can_frame.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <vector>

namespace rc10::test::can_frame_test {
namespace {

std::vector<std::uint8_t> counting(std::size_t length) {
  std::vector<std::uint8_t> bytes(length);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

TEST(CanFrame, StandardAndExtendedIdsWithTheSameNumberAreDifferent) {
  EXPECT_NE((CanId{0x201, false}), (CanId{0x201, true}));
  EXPECT_EQ((CanId{0x201, true}), (CanId{0x201, true}));
}

TEST(CanFrame, DescribesAnIdWithItsFormat) {
  EXPECT_EQ(describe({0x1F, false}), "standard id 0x01F");
  EXPECT_EQ(describe({0x901, true}), "extended id 0x00000901");
}

TEST(CanFrame, RoundsUpToTheNextFdLength) {
  for (std::size_t bytes = 0; bytes <= 8; ++bytes) EXPECT_EQ(roundUpFdLength(bytes), bytes);
  EXPECT_EQ(roundUpFdLength(9), 12);
  EXPECT_EQ(roundUpFdLength(19), 20);
  EXPECT_EQ(roundUpFdLength(20), 20);
  EXPECT_EQ(roundUpFdLength(25), 32);
  EXPECT_EQ(roundUpFdLength(49), 64);
  EXPECT_EQ(roundUpFdLength(1000), 64);
}

TEST(CanFrame, KnowsTheLengthsOfEachFormat) {
  EXPECT_TRUE(isValidLength(false, 8));
  EXPECT_FALSE(isValidLength(false, 9));
  EXPECT_FALSE(isValidLength(false, 12));
  EXPECT_TRUE(isValidLength(true, 0));
  EXPECT_TRUE(isValidLength(true, 12));
  EXPECT_FALSE(isValidLength(true, 13));
  EXPECT_FALSE(isValidLength(true, 65));
}

TEST(CanFrame, AClassicFrameTakesEightBytesAndNoMore) {
  const auto bytes = counting(10);
  const CanFrame frame = makeClassicFrame({0x200, false}, bytes);
  EXPECT_FALSE(frame.fd);
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.payload().back(), 8);
  EXPECT_EQ(frame.data[8], 0);
  EXPECT_EQ(makeClassicFrame({0x200, false}, {}).length, 0);
}

TEST(CanFrame, AnFdFrameIsPaddedToAValidLength) {
  const CanFrame frame = makeFdFrame({0x8001, true}, counting(19), true, 0x50);
  EXPECT_TRUE(frame.fd);
  EXPECT_TRUE(frame.bit_rate_switch);
  EXPECT_EQ(frame.length, 20);
  EXPECT_EQ(frame.data[18], 19);
  EXPECT_EQ(frame.data[19], 0x50);
  EXPECT_EQ(frame.data[20], 0);
}

TEST(CanFrame, AnFdFrameOfAValidLengthIsNotPadded) {
  const CanFrame frame = makeFdFrame({1, false}, counting(64), false, 0xFF);
  EXPECT_EQ(frame.length, 64);
  EXPECT_EQ(frame.data[63], 64);
  EXPECT_FALSE(frame.bit_rate_switch);
}

TEST(CanFrame, AnFdFrameCutsOffWhatDoesNotFit) {
  const CanFrame frame = makeFdFrame({1, false}, counting(70), false);
  EXPECT_EQ(frame.length, 64);
  EXPECT_EQ(frame.data[63], 64);
}

}  // namespace
}  // namespace rc10::test::can_frame_test
