#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "module/serial_link_board.hpp"
#include "module/serial_link_field.hpp"

namespace rc10::test::serial_link_field_test {
namespace {

using namespace serial_link_board;

TEST(SerialLinkField, EveryTypeKeepsWhatItCanSayAndCutsOffTheRest) {
  constexpr std::array<std::pair<WireType, std::pair<double, double>>, 6> kRanges{
      {{WireType::kU8, {0, 255}},
       {WireType::kI8, {-128, 127}},
       {WireType::kU16, {0, 65535}},
       {WireType::kI16, {-32768, 32767}},
       {WireType::kU32, {0, 4294967295.0}},
       {WireType::kI32, {-2147483648.0, 2147483647.0}}}};
  std::array<std::uint8_t, 4> bytes{};
  for (const auto& [type, range] : kRanges) {
    for (const double value : {range.first, range.second, 0.0, 7.0}) {
      writeWire(type, value, bytes);
      EXPECT_EQ(readWire(type, bytes), value);
    }
    writeWire(type, 1e300, bytes);
    EXPECT_EQ(readWire(type, bytes), range.second);
    writeWire(type, -1e300, bytes);
    EXPECT_EQ(readWire(type, bytes), range.first);
    writeWire(type, kNoSignal, bytes);
    EXPECT_EQ(readWire(type, bytes), 0.0);
  }
  writeWire(WireType::kF32, -0.5, bytes);
  EXPECT_EQ(readWire(WireType::kF32, bytes), -0.5);
  writeWire(WireType::kF32, 1e300, bytes);
  EXPECT_TRUE(std::isfinite(readWire(WireType::kF32, bytes)));
}

}  // namespace
}  // namespace rc10::test::serial_link_field_test
