#include "web/page_messages.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "web/columns_frame.hpp"

namespace rc10::web::test::page_messages_test {
namespace {

template <typename Number>
Number at(const std::vector<std::byte>& bytes, std::size_t offset) {
  Number number{};
  EXPECT_LE(offset + sizeof number, bytes.size());
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

client::Curve curveOf(std::size_t ticks) {
  client::Curve curve(ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    curve[i].time_s = static_cast<double>(i);
    curve[i].target = 60.0;
    curve[i].limits = 4;
  }
  return curve;
}

// The page reads it so: web/src/protocol.ts.
TEST(CurveFrame, IsLaidOutAsThePageReadsIt) {
  const auto bytes = curveFrame(curveOf(3), 77, 1);
  ASSERT_EQ(bytes.size(), 32U + 9 * 2 * sizeof(double));
  EXPECT_EQ(at<std::uint8_t>(bytes, 0), kFrameVersion);
  EXPECT_EQ(at<std::uint8_t>(bytes, 1), 5);
  EXPECT_EQ(at<std::uint16_t>(bytes, 2), 9);
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(at<double>(bytes, 16), 77.0);
  EXPECT_EQ(at<double>(bytes, 24), 1.0);
  EXPECT_EQ(at<double>(bytes, 32), 1.0);                  // time of the second tick
  EXPECT_EQ(at<double>(bytes, 32 + 2 * 8), 60.0);         // its target
  EXPECT_EQ(at<double>(bytes, 32 + 8 * 2 * 8 + 8), 4.0);  // limits of the last
}

TEST(CurveFrame, ALongCurveComesInPiecesAndNothingLiesBeyondItsEnd) {
  const auto curve = curveOf(kMaxCurveTicks + 10);
  EXPECT_EQ(at<std::uint32_t>(curveFrame(curve, 1, 0), 4), kMaxCurveTicks);
  EXPECT_EQ(at<std::uint32_t>(curveFrame(curve, 1, kMaxCurveTicks), 4), 10U);
  EXPECT_EQ(curveFrame(curve, 1, 1U << 31U).size(), 32U);
}

}  // namespace
}  // namespace rc10::web::test::page_messages_test
