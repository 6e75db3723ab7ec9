#include "app/vocabulary.hpp"

#include <gtest/gtest.h>

namespace rc10::test::vocabulary_test {
namespace {

TEST(Vocabulary, NumbersOfOtherProgramsHaveAWordToo) {
  for (int number = 0; number < 256; ++number) {
    EXPECT_NE(toString(static_cast<ControlMode>(number)), nullptr);
    EXPECT_NE(toString(static_cast<MotorStatus>(number)), nullptr);
    EXPECT_NE(toString(static_cast<RobotStatus>(number)), nullptr);
    EXPECT_NE(toString(static_cast<BusState>(number)), nullptr);
    EXPECT_NE(toString(static_cast<CommandUnit>(number)), nullptr);
    EXPECT_NE(toString(static_cast<Severity>(number)), nullptr);
    EXPECT_NE(toString(static_cast<Operation>(number)), nullptr);
    EXPECT_NE(unitOf(static_cast<ControlMode>(number)), nullptr);
  }
  EXPECT_STREQ(toString(MotorStatus{200}), "UNKNOWN");
  EXPECT_STREQ(toString(ControlMode{9}), "unknown");
  EXPECT_STREQ(unitOf(ControlMode{9}), "");
}

TEST(Vocabulary, WordsAreInTheOrderOfTheNumbers) {
  EXPECT_STREQ(toString(ControlMode::kTotalAngle), "total_angle");
  EXPECT_STREQ(toString(ControlMode::kBrake), "brake");
  EXPECT_STREQ(toString(MotorStatus::kFault), "FAULT");
  EXPECT_STREQ(toString(RobotStatus::kStopping), "STOPPING");
  EXPECT_STREQ(toString(BusState::kStalled), "stalled");
  EXPECT_STREQ(toString(CommandUnit::kNative), "native");
  EXPECT_STREQ(toString(Severity::kError), "error");
  EXPECT_STREQ(toString(Operation::kConfigure), "configure-drive");
  EXPECT_STREQ(toString(Operation::kEnableAlone), "enable_alone");
  EXPECT_STREQ(toString(Operation::kLoad), "load");
  EXPECT_STREQ(toString(Operation::kScan), "scan");
}

TEST(Vocabulary, EachOperationIsFoundByItsWordAlone) {
  for (std::size_t i = 0; i < kOperationWords.size(); ++i)
    EXPECT_EQ(operationNamed(kOperationWords[i]), static_cast<Operation>(i));
  for (const auto* word : {"", "Enable", "enable ", "unknown"}) EXPECT_FALSE(operationNamed(word)) << word;
}

TEST(Vocabulary, UnitsAreThoseOfTheTargets) {
  EXPECT_STREQ(unitOf(ControlMode::kCurrent), "A");
  EXPECT_STREQ(unitOf(ControlMode::kVelocity), "rpm");
  EXPECT_STREQ(unitOf(ControlMode::kTotalAngle), "deg");
  EXPECT_STREQ(unitOf(ControlMode::kDuty), "");
}

}  // namespace
}  // namespace rc10::test::vocabulary_test
