#include "bus/frame_listener.hpp"

#include <gtest/gtest.h>

#include <array>

#include "bus/fake_devices.hpp"

namespace rc10::test::frame_listener_test {
namespace {

CanFrame frameWith(CanId id, std::initializer_list<std::uint8_t> payload = {}) {
  return makeClassicFrame(id, std::span(payload.begin(), payload.size()));
}

FrameFilter withByte(FrameFilter filter, std::uint8_t index, std::uint8_t mask, std::uint8_t value) {
  filter.discriminators[0] = PayloadDiscriminator{index, mask, value};
  return filter;
}

TEST(FrameFilter, AcceptsItsIdOnly) {
  EXPECT_TRUE(accepts(standardFilter(0x201), frameWith({0x201, false})));
  EXPECT_FALSE(accepts(standardFilter(0x201), frameWith({0x202, false})));
}

TEST(FrameFilter, DistinguishesStandardFromExtended) {
  EXPECT_FALSE(accepts(standardFilter(0x201), frameWith({0x201, true})));
  EXPECT_FALSE(accepts(extendedFilter(0x201), frameWith({0x201, false})));
  EXPECT_TRUE(accepts(extendedFilter(0x201), frameWith({0x201, true})));
}

TEST(FrameFilter, FindsTheMotorIdInsideAVaryingExtendedId) {
  const FrameFilter filter = robStrideFilter(0x7F);
  EXPECT_TRUE(accepts(filter, frameWith({0x0280'7FFD, true})));
  EXPECT_TRUE(accepts(filter, frameWith({0x1500'7F00, true})));
  EXPECT_FALSE(accepts(filter, frameWith({0x0280'7EFD, true})));
}

TEST(FrameFilter, ReadsThePayloadOnlyWhereTheMaskSays) {
  const FrameFilter filter = damiaoFilter(0x11, 3);
  EXPECT_TRUE(accepts(filter, frameWith({0x11, false}, {0x13})));
  EXPECT_TRUE(accepts(filter, frameWith({0x11, false}, {0xF3})));
  EXPECT_FALSE(accepts(filter, frameWith({0x11, false}, {0x14})));
}

TEST(FrameFilter, IgnoresBitsOfTheValueOutsideTheMask) {
  EXPECT_TRUE(accepts(withByte(standardFilter(1), 0, 0x0F, 0xF3), frameWith({1, false}, {0x03})));
}

TEST(FrameFilter, RefusesAFrameTooShortToHaveTheByte) {
  const FrameFilter filter = withByte(standardFilter(0x11), 2, 0xFF, 0x00);
  EXPECT_FALSE(accepts(filter, frameWith({0x11, false}, {1, 2})));
  EXPECT_TRUE(accepts(filter, frameWith({0x11, false}, {1, 2, 0})));
}

TEST(FrameFilter, ASecondByteMustFitAsWell) {
  FrameFilter filter = withByte(standardFilter(0x7FF), 0, 0xFF, 1);
  filter.discriminators[1] = PayloadDiscriminator{.byte_index = 2, .value = 0x55};
  EXPECT_TRUE(accepts(filter, frameWith({0x7FF, false}, {1, 0, 0x55, 9})));
  EXPECT_FALSE(accepts(filter, frameWith({0x7FF, false}, {1, 0, 0x33, 9})));
  EXPECT_FALSE(accepts(filter, frameWith({0x7FF, false}, {2, 0, 0x55, 9})));
  EXPECT_FALSE(accepts(filter, frameWith({0x7FF, false}, {1, 0})));
  EXPECT_TRUE(overlaps(filter, withByte(standardFilter(0x7FF), 2, 0xFF, 0x55)));
  EXPECT_FALSE(overlaps(filter, withByte(standardFilter(0x7FF), 2, 0xFF, 0x33)));
  EXPECT_FALSE(overlaps(withByte(standardFilter(0x7FF), 0, 0xFF, 2), filter));
}

TEST(FrameFilter, ASecondByteMayStandAlone) {
  FrameFilter filter = standardFilter(0x7FF);
  filter.discriminators[1] = PayloadDiscriminator{.byte_index = 2, .value = 0x55};
  EXPECT_TRUE(accepts(filter, frameWith({0x7FF, false}, {1, 0, 0x55})));
  EXPECT_FALSE(accepts(filter, frameWith({0x7FF, false}, {1, 0, 0x33})));
  EXPECT_FALSE(overlaps(filter, withByte(standardFilter(0x7FF), 2, 0xFF, 0x33)));
}

TEST(FrameFilter, OneThatContradictsItselfOverlapsNone) {
  FrameFilter filter = withByte(standardFilter(0x7FF), 0, 0x0F, 1);
  filter.discriminators[1] = PayloadDiscriminator{.byte_index = 0, .mask = 0x03, .value = 2};
  EXPECT_FALSE(accepts(filter, frameWith({0x7FF, false}, {1})));
  EXPECT_FALSE(overlaps(filter, standardFilter(0x7FF)));
}

TEST(FrameFilter, AcceptsNeitherRemoteNorErrorFrames) {
  CanFrame frame = frameWith({0x4, false});
  frame.type = FrameType::kRemote;
  EXPECT_FALSE(accepts(standardFilter(0x4), frame));
  frame.type = FrameType::kError;
  EXPECT_FALSE(accepts(standardFilter(0x4), frame));
}

TEST(FrameFilter, AcceptsNoIdThatDoesNotExist) {
  EXPECT_FALSE(accepts(standardFilter(0x001), frameWith({0x801, false})));
}

TEST(FrameFilter, SameIdOverlapsAndAnotherDoesNot) {
  EXPECT_TRUE(overlaps(standardFilter(0x205), standardFilter(0x205)));
  EXPECT_FALSE(overlaps(standardFilter(0x205), standardFilter(0x206)));
}

TEST(FrameFilter, SameNumberInTheOtherFormatDoesNotOverlap) {
  EXPECT_FALSE(overlaps(standardFilter(0x205), extendedFilter(0x205)));
}

TEST(FrameFilter, MasksOverlapUnlessTheyDifferInACommonBit) {
  EXPECT_FALSE(overlaps(robStrideFilter(1), robStrideFilter(2)));
  EXPECT_TRUE(overlaps(robStrideFilter(1), robStrideFilter(1)));
  // A VESC's status id 0x0901 reads as RobStride motor 9.
  EXPECT_TRUE(overlaps(robStrideFilter(9), extendedFilter(0x0901)));
  EXPECT_FALSE(overlaps(robStrideFilter(8), extendedFilter(0x0901)));
  const FrameFilter low{.id = {0x01, true}, .mask = 0x0000'00FF};
  EXPECT_TRUE(overlaps(low, robStrideFilter(1)));  // no bit in common: 0x0101 satisfies both
}

TEST(FrameFilter, MaskBitsBeyondAStandardIdMeanNothing) {
  const FrameFilter all_bits{.id = {0x205, false}, .mask = 0xFFFF'FFFF};
  EXPECT_TRUE(overlaps(all_bits, standardFilter(0x205)));
  EXPECT_TRUE(accepts(all_bits, frameWith({0x205, false})));
}

TEST(FrameFilter, DisjointValuesOfTheSameByteDoNotOverlap) {
  EXPECT_FALSE(overlaps(damiaoFilter(0, 1), damiaoFilter(0, 2)));
  EXPECT_TRUE(overlaps(damiaoFilter(0, 1), damiaoFilter(0, 1)));
}

TEST(FrameFilter, DiscriminatorsOfDifferentBytesOverlap) {
  EXPECT_TRUE(overlaps(withByte(standardFilter(0), 0, 0xFF, 1), withByte(standardFilter(0), 1, 0xFF, 2)));
}

TEST(FrameFilter, DiscriminatorsWithoutACommonBitOverlap) {
  EXPECT_TRUE(overlaps(withByte(standardFilter(0), 0, 0x0F, 1), withByte(standardFilter(0), 0, 0xF0, 0x20)));
  EXPECT_FALSE(
      overlaps(withByte(standardFilter(0), 0, 0x1F, 0x11), withByte(standardFilter(0), 0, 0xF0, 0x20)));
}

TEST(FrameFilter, AFilterWithoutDiscriminatorOverlapsOneWith) {
  EXPECT_TRUE(overlaps(standardFilter(0x11), damiaoFilter(0x11, 1)));
  EXPECT_TRUE(overlaps(damiaoFilter(0x11, 1), standardFilter(0x11)));
}

}  // namespace
}  // namespace rc10::test::frame_listener_test
