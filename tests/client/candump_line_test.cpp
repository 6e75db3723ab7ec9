#include "client/candump_line.hpp"

#include <gtest/gtest.h>

#include "blackbox/memory_box.hpp"

namespace rc10::test::candump_line_test {
namespace {

blackbox::Frame makeFrame(std::uint32_t id, std::uint8_t flags, std::vector<std::uint8_t> data = {}) {
  blackbox::Frame frame;
  frame.header.id = id;
  frame.header.flags = flags;
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

TEST(CandumpLine, IsThatOfCandump) {
  MemoryBox box;
  box.head().control.wall_offset_ns = 1'436'509'052'000'000'000;
  const auto recording = box.recording();
  auto frame = makeFrame(0x201, 8, {0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77});
  frame.header.time_ns = 249'713'999;
  EXPECT_EQ(client::candumpLine(recording, frame), "(1436509052.249713) can0 201#0011223344556677 R");
  frame.header.flags |= blackbox::kFrameSent;
  EXPECT_EQ(client::candumpLine(recording, frame), "(1436509052.249713) can0 201#0011223344556677 T");
}

TEST(CandumpLine, ASimulatedBusAppearsUnderItsName) {
  MemoryBox box;
  box.head().header.buses[0].interface = "";
  EXPECT_EQ(client::candumpLine(box.recording(), makeFrame(0x1, 0)), "(0000000000.000000) chassis 001# R");
}

TEST(CandumpLine, ATimeThatCannotBeIsZero) {
  auto frame = makeFrame(0x1, 0);
  frame.header.time_ns = INT64_MIN;
  EXPECT_EQ(client::candumpLine(MemoryBox{}.recording(), frame), "(0000000000.000000) can0 001# R");
}

TEST(FrameText, EveryKindOfFrameHasTheFormOfCanUtils) {
  using client::frameText;
  EXPECT_EQ(frameText(makeFrame(0x7FF, 0)), "7FF#");
  EXPECT_EQ(frameText(makeFrame(0x123U | blackbox::kIdExtended, 2, {0xAB, 0xCD})), "00000123#ABCD");
  EXPECT_EQ(frameText(makeFrame(0x1FFFFFFFU | blackbox::kIdExtended, 0)), "1FFFFFFF#");
  EXPECT_EQ(frameText(makeFrame(0x5U | blackbox::kIdRemote, 0)), "005#R");
  EXPECT_EQ(frameText(makeFrame(0x5U | blackbox::kIdRemote, 4)), "005#R4");
  EXPECT_EQ(frameText(makeFrame(0x40U | blackbox::kIdError, 8)), "20000040#0000000000000000");
  const std::vector<std::uint8_t> twelve(12, 0x5A);
  EXPECT_EQ(frameText(makeFrame(0x10, blackbox::kFrameFd | 9, twelve)), "010##05A5A5A5A5A5A5A5A5A5A5A5A");
  EXPECT_EQ(frameText(makeFrame(0x10, blackbox::kFrameFd | blackbox::kFrameBitRateSwitch | 1, {1})),
            "010##101");
}

}  // namespace
}  // namespace rc10::test::candump_line_test
