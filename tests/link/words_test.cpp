#include "link/words.hpp"

#include <gtest/gtest.h>

#include "app/vocabulary.hpp"

namespace rc10::link::test::words_test {
namespace {

TEST(Words, ModesAreFoundByTheirWords) {
  for (int number = 0; number < kControlModeCount; ++number) {
    const auto mode = static_cast<ControlMode>(number);
    EXPECT_EQ(modeOf(toString(mode)), mode);
  }
}

TEST(Words, UnknownModeIsNotAMode) {
  EXPECT_FALSE(modeOf("wobble").has_value());
  EXPECT_FALSE(modeOf("").has_value());
  EXPECT_FALSE(modeOf("VELOCITY").has_value());
}

TEST(Words, SetsAreListed) {
  EXPECT_EQ(modeWords(0), "");
  EXPECT_EQ(modeWords(0b110), "current,velocity");
  EXPECT_EQ(modeWords(0xFFFFFFFF), "coast,current,velocity,angle,total_angle,impedance,voltage,duty,brake");
  EXPECT_EQ(limitWords(1U | 32U), "current,stall");
  EXPECT_EQ(limitWords(0xFFFFFFC0), "");
}

TEST(Words, FaultIsEmptyWithoutOne) {
  EXPECT_EQ(faultText(0), "");
  EXPECT_EQ(faultText(3), "stalled: at its limit without turning; see what blocks it");
  EXPECT_EQ(faultText(17), "fault 17");
}

TEST(Words, GainsAreNamedAsTheirKeys) {
  EXPECT_STREQ(gainWord(0), "velocity_pid.kp_a_per_rpm");
  EXPECT_STREQ(gainWord(256), "velocity_pid.kp_v_per_rpm");
  EXPECT_STREQ(gainWord(256 + 15), "angle_pid.derivative_filter_hz");
  for (const int stranger : {-1, 16, 255, 512, 1 << 30}) EXPECT_STREQ(gainWord(stranger), "unknown gain");
}

}  // namespace
}  // namespace rc10::link::test::words_test
