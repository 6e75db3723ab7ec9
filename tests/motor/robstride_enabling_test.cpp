#include <array>
#include <bit>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "motor/robstride_bench.hpp"

namespace rc10::test::robstride_enabling_test {
namespace {

using namespace robstride_bench;

// --- Enabling

TEST(RobStrideMotor, EnablingSetsAndReadsBackAndThenHasNoTorque) {
  Bench bench(robStrideSettings("RS00"));
  auto frames = bench.tick(FrameKind::kEnable);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(typeOf(frames[0]), 4U);
  EXPECT_TRUE(bench.tick().empty());  // waits for the answer
  bench.say({.position_rad = 0.4, .mode = 0});

  const std::array<std::uint16_t, 3> settings{robstride::parameter::kRunMode,
                                              robstride::parameter::kTorqueLimit, 0x7028};
  for (const auto index : settings) {
    frames = bench.tick();
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(typeOf(frames[0]), 18U);
    EXPECT_EQ(typeOf(frames[1]), 17U);
    EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), index);
    bench.say({.position_rad = 0.4, .mode = 0});
    bench.parameter(index, readLittleEndian<std::uint32_t>(frames[0].payload(), 4));
  }
  frames = bench.tick();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kPosition);
  bench.parameter(robstride::parameter::kPosition, std::bit_cast<std::uint32_t>(0.4F));

  frames = bench.tick();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(typeOf(frames[1]), 3U);
  for (const std::size_t around : {0U, 2U}) {
    EXPECT_EQ(bench.codec.operation(frames[around]).stiffness_nm_per_rad, 0.0);
    EXPECT_NEAR(bench.codec.operation(frames[around]).torque_nm, 0.0, 1e-3);
  }
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
  bench.run(0.4);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kDone);
  frames = bench.tick();
  EXPECT_EQ(bench.codec.operation(frames.at(0)).stiffness_nm_per_rad, 0.0);
}

TEST(RobStrideMotor, AnUnansweredStepIsSentFiveTimesAndThenFails) {
  Bench bench(robStrideSettings("RS00"));
  int sent = 0;
  for (int i = 0; i < 251; ++i) sent += static_cast<int>(bench.tick(FrameKind::kEnable).size());
  EXPECT_EQ(sent, 5);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kFailed);
  bench.tick(FrameKind::kPoll);
  EXPECT_EQ(bench.tick(FrameKind::kEnable).size(), 1U);  // anew
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
}

TEST(RobStrideMotor, ASettingThatTheDriveDoesNotKeepFailsTheEnabling) {
  Bench bench(robStrideSettings("RS00"));
  bench.tick(FrameKind::kEnable);
  bench.say({.mode = 0});
  int asked = 0;
  for (int i = 0; i < 400; ++i) {
    for (const auto& frame : bench.tick()) {
      EXPECT_NE(typeOf(frame), 3U);
      if (typeOf(frame) == 17) bench.parameter(robstride::parameter::kRunMode, 2);
      asked += typeOf(frame) == 17 ? 1 : 0;
    }
  }
  EXPECT_GT(asked, 0);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kFailed);
}

TEST(RobStrideMotor, ALimitMayBecomeSmallerButNotLarger) {
  const auto limit = RobstrideSetting::limit(robstride::parameter::kCurrentLimit, 23.0F);
  EXPECT_TRUE(limit.agrees(std::bit_cast<std::uint32_t>(16.0F)));
  EXPECT_TRUE(limit.agrees(std::bit_cast<std::uint32_t>(23.0F)));
  EXPECT_FALSE(limit.agrees(std::bit_cast<std::uint32_t>(30.0F)));
  EXPECT_FALSE(limit.agrees(std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN())));
}

TEST(RobStrideMotor, NoFrameEverSavesOrChangesASettingForGood) {
  for (const std::string control : {"operation", "current", "velocity", "position"}) {
    Bench bench(controlled(control));
    for (const auto kind : {FrameKind::kPoll, FrameKind::kEnable, FrameKind::kIdle, FrameKind::kCommand,
                            FrameKind::kBrake, FrameKind::kRest, FrameKind::kDisable}) {
      int told = 0;
      for (int i = 0; i < 60; ++i) {
        bench.run();
        for (const auto& frame : bench.tick(kind)) {
          const auto type = typeOf(frame);
          EXPECT_TRUE(type == 1 || type == 3 || type == 4 || type == 17 || type == 18) << type;
          ++told;
        }
      }
      EXPECT_GT(told, 0) << control;
    }
  }
}

}  // namespace
}  // namespace rc10::test::robstride_enabling_test
