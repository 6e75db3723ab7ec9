#include "web/columns_frame.hpp"

#include <array>
#include <cstring>

#include <gtest/gtest.h>

namespace rc10::web::test::columns_frame_test {
namespace {

template <typename Number>
Number at(const std::vector<std::byte>& bytes, std::size_t offset) {
  Number number{};
  EXPECT_LE(offset + sizeof number, bytes.size());
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

// The page reads it so: web/src/protocol.ts.
TEST(ColumnsFrame, IsLaidOutAsThePageReadsIt) {
  const link::TraceSignal velocity{link::TraceSource::kMotor, 0, 8};
  const link::TraceSignal current{link::TraceSource::kMotor, 0, 9};
  TraceStore store(10);
  store.choose(std::array{velocity, current});
  link::TraceRow row{.mono_us = 5000, .tick = 5, .values = {}};
  row.values[0] = 1.5;
  row.values[1] = -2.5;
  store.add(row);
  const View view{.signals = {velocity, current}, .column_us = 1000};
  const auto bytes = columnsFrame(store, view, FrameKind::kReset, 77, 4, 3);
  ASSERT_EQ(bytes.size(), 32U + 2 * 3 * 2 * sizeof(float));
  EXPECT_EQ(at<std::uint8_t>(bytes, 0), kFrameVersion);
  EXPECT_EQ(at<std::uint8_t>(bytes, 1), 2);
  EXPECT_EQ(at<std::uint16_t>(bytes, 2), 2);
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 3U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 8), 77U);
  EXPECT_EQ(at<double>(bytes, 16), 4.0);
  EXPECT_EQ(at<double>(bytes, 24), 1000.0);
  EXPECT_EQ(at<float>(bytes, 32 + 4), 1.5F);              // velocity, least, column 5
  EXPECT_EQ(at<float>(bytes, 32 + 12 + 4), 1.5F);         // its greatest
  EXPECT_EQ(at<float>(bytes, 32 + 24 + 4), -2.5F);        // current
  EXPECT_NE(at<float>(bytes, 32), at<float>(bytes, 32));  // NaN
}

TEST(ColumnsFrame, NoPageGetsMoreColumnsThanAScreenHas) {
  const TraceStore store(10);
  const auto bytes =
      columnsFrame(store, {.signals = {{}}, .column_us = 100}, FrameKind::kRange, 1, 0, 1U << 30U);
  EXPECT_EQ(bytes.size(), 32U + kMaxColumns * 2 * sizeof(float));
}

}  // namespace
}  // namespace rc10::web::test::columns_frame_test
