#include "link/words.hpp"

#include <gtest/gtest.h>

#include "motor/target.hpp"

namespace rc10::link::test::words_test {
namespace {

TEST(Words, ModesAreThoseOfTheMotorLayer) {
  ASSERT_EQ(kModeCount, kControlModeCount);
  for (std::uint8_t mode = 0; mode < kModeCount; ++mode) {
    EXPECT_STREQ(modeWord(mode), toString(static_cast<ControlMode>(mode)));
    EXPECT_EQ(modeOf(modeWord(mode)), mode);
  }
  EXPECT_EQ(kModeCoast, static_cast<std::uint8_t>(ControlMode::kCoast));
  EXPECT_EQ(kModeImpedance, static_cast<std::uint8_t>(ControlMode::kImpedance));
  EXPECT_EQ(kModeBrake, static_cast<std::uint8_t>(ControlMode::kBrake));
}

TEST(Words, NumbersOfStrangersHaveAWordToo) {
  for (int number = 0; number < 256; ++number) {
    const auto value = static_cast<std::uint8_t>(number);
    for (const char* word : {motorStatusWord(value), robotStateWord(value), busStateWord(value),
                             severityWord(value), modeWord(value), modeUnit(value), commandUnitWord(value)}) {
      EXPECT_NE(word, nullptr);
    }
  }
  EXPECT_STREQ(motorStatusWord(200), "UNKNOWN");
  EXPECT_STREQ(modeWord(9), "unknown");
  EXPECT_STREQ(modeUnit(9), "");
}

TEST(Words, UnknownModeIsNotAMode) {
  EXPECT_FALSE(modeOf("wobble").has_value());
  EXPECT_FALSE(modeOf("").has_value());
  EXPECT_FALSE(modeOf("VELOCITY").has_value());
}

TEST(Words, UnitsAreThoseOfTheTargets) {
  EXPECT_STREQ(modeUnit(*modeOf("current")), "A");
  EXPECT_STREQ(modeUnit(*modeOf("velocity")), "rpm");
  EXPECT_STREQ(modeUnit(*modeOf("total_angle")), "deg");
  EXPECT_STREQ(modeUnit(*modeOf("duty")), "");
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
