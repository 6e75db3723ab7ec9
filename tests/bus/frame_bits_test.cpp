#include "bus/frame_bits.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace rc10::test::frame_bits_test {
namespace {

constexpr FrameShape classic(bool extended, std::size_t length) { return {extended, false, false, length}; }
constexpr FrameShape fdFrame(bool extended, std::size_t length) { return {extended, true, true, length}; }

struct ClassicRow {
  std::size_t length;
  std::uint32_t standard_none, standard_worst, extended_none, extended_worst;
};

struct FdRow {
  std::size_t length;
  std::uint32_t standard_none, standard_worst, extended_none, extended_worst;
  double standard_5m_us, extended_5m_us, standard_8m_us;
};

// Both tables were checked against brute-force stuffing of the worst pattern.
constexpr std::array kClassic{
    ClassicRow{0, 47, 55, 67, 80},  ClassicRow{1, 55, 65, 75, 90},    ClassicRow{2, 63, 75, 83, 100},
    ClassicRow{4, 79, 95, 99, 120}, ClassicRow{6, 95, 115, 115, 140}, ClassicRow{8, 111, 135, 131, 160},
};

constexpr std::array kFd{
    FdRow{0, 62, 67, 81, 91, 39.8, 63.0, 37.2},         FdRow{8, 126, 147, 145, 171, 55.8, 79.0, 47.2},
    FdRow{12, 158, 187, 177, 211, 63.8, 87.0, 52.2},    FdRow{16, 190, 227, 209, 251, 71.8, 95.0, 57.2},
    FdRow{20, 227, 272, 246, 296, 80.8, 104.0, 62.9},   FdRow{24, 259, 312, 278, 336, 88.8, 112.0, 67.9},
    FdRow{32, 323, 392, 342, 416, 104.8, 128.0, 77.9},  FdRow{48, 451, 552, 470, 576, 136.8, 160.0, 97.9},
    FdRow{64, 579, 712, 598, 736, 168.8, 192.0, 117.9},
};

double microseconds(Duration time) { return std::chrono::duration<double, std::micro>(time).count(); }

// The load check of a configuration can run at compile time.
static_assert(unstuffedBits(classic(false, 8)).total() == 111);
static_assert(worstCaseBits(classic(false, 8)).total() == 135);

TEST(FrameBits, ClassicFramesHaveTheTabulatedBits) {
  for (const ClassicRow& row : kClassic) {
    SCOPED_TRACE(row.length);
    EXPECT_EQ(unstuffedBits(classic(false, row.length)), (FrameBits{row.standard_none, 0}));
    EXPECT_EQ(worstCaseBits(classic(false, row.length)), (FrameBits{row.standard_worst, 0}));
    EXPECT_EQ(unstuffedBits(classic(true, row.length)), (FrameBits{row.extended_none, 0}));
    EXPECT_EQ(worstCaseBits(classic(true, row.length)), (FrameBits{row.extended_worst, 0}));
  }
}

TEST(FrameBits, ClassicFramesFollowTheClosedFormulas) {
  for (std::size_t n = 0; n <= 8; ++n) {
    EXPECT_EQ(unstuffedBits(classic(false, n)).total(), 47 + 8 * n);
    EXPECT_EQ(worstCaseBits(classic(false, n)).total(), 55 + 10 * n);
    EXPECT_EQ(unstuffedBits(classic(true, n)).total(), 67 + 8 * n);
    EXPECT_EQ(worstCaseBits(classic(true, n)).total(), 80 + 10 * n);
  }
}

TEST(FrameBits, FdFramesHaveTheTabulatedBits) {
  for (const FdRow& row : kFd) {
    SCOPED_TRACE(row.length);
    EXPECT_EQ(unstuffedBits(fdFrame(false, row.length)).total(), row.standard_none);
    EXPECT_EQ(worstCaseBits(fdFrame(false, row.length)).total(), row.standard_worst);
    EXPECT_EQ(unstuffedBits(fdFrame(true, row.length)).total(), row.extended_none);
    EXPECT_EQ(worstCaseBits(fdFrame(true, row.length)).total(), row.extended_worst);
  }
}

TEST(FrameBits, FdFramesTakeTheTabulatedTime) {
  constexpr double kRoundingUs = 0.0501;  // the table has one decimal
  for (const FdRow& row : kFd) {
    SCOPED_TRACE(row.length);
    const FrameBits standard = worstCaseBits(fdFrame(false, row.length));
    const FrameBits extended = worstCaseBits(fdFrame(true, row.length));
    EXPECT_NEAR(microseconds(frameTime(standard, {1'000'000, 5'000'000})), row.standard_5m_us, kRoundingUs);
    EXPECT_NEAR(microseconds(frameTime(extended, {1'000'000, 5'000'000})), row.extended_5m_us, kRoundingUs);
    EXPECT_NEAR(microseconds(frameTime(standard, {1'000'000, 8'000'000})), row.standard_8m_us, kRoundingUs);
  }
}

TEST(FrameBits, OnlyTheArbitrationAndTheEndOfAnFdFrameStayAtTheNominalRate) {
  EXPECT_EQ(unstuffedBits(fdFrame(false, 64)).nominal, 17U + 12U);
  EXPECT_EQ(worstCaseBits(fdFrame(false, 64)).nominal, 17U + 4U + 12U);
  EXPECT_EQ(unstuffedBits(fdFrame(true, 64)).nominal, 36U + 12U);
  EXPECT_EQ(worstCaseBits(fdFrame(true, 64)).nominal, 36U + 8U + 12U);
}

TEST(FrameBits, AnFdFrameWithoutBitRateSwitchIsAllNominal) {
  FrameShape shape = fdFrame(false, 32);
  shape.bit_rate_switch = false;
  EXPECT_EQ(worstCaseBits(shape), (FrameBits{392, 0}));
  EXPECT_EQ(frameTime(worstCaseBits(shape), {1'000'000, 5'000'000}), std::chrono::microseconds(392));
}

TEST(FrameBits, ADataPhaseWithoutARateOfItsOwnRunsAtTheNominalOne) {
  EXPECT_EQ(frameTime({33, 67}, {1'000'000, 0}), std::chrono::microseconds(100));
}

TEST(FrameBits, TimeIsRoundedUp) { EXPECT_EQ(frameTime({1, 0}, {333'333, 0}), Duration{3001}); }

TEST(FrameBits, ARemoteFrameCarriesNoPayload) {
  CanFrame frame = makeClassicFrame({0x123, false}, {});
  frame.length = 8;
  frame.type = FrameType::kRemote;
  EXPECT_EQ(unstuffedBits(shapeOf(frame)).total(), 47U);
}

TEST(FrameBits, TheShapeOfAFrameIsItsOwn) {
  const CanFrame frame = makeFdFrame({0x8001, true}, std::array<std::uint8_t, 13>{}, true);
  EXPECT_EQ(worstCaseBits(shapeOf(frame)).total(), 251U);
}

}  // namespace
}  // namespace rc10::test::frame_bits_test
