// A drive that is told to rest: what is evidence of torque, and what is not.
#include <gtest/gtest.h>

#include <limits>

#include "motor/guarding/rest_check.hpp"

namespace rc10::test::rest_check_test {
namespace {

using namespace std::chrono_literals;
using Verdict = RestCheck::Verdict;

constexpr float kStandstillRpm = 10.0F;
constexpr RestConfig kConfig{.current_a = 1.0F, .time = 100ms, .gained_rpm = 50.0F};

class RestCheckTest : public ::testing::Test {
 protected:
  /// One sample after another, a millisecond apart; the last verdict that is not kRests, and when it came.
  Verdict run(int samples, float current_a, float rpm, bool told = true) {
    Verdict last = Verdict::kRests;
    for (int i = 0; i < samples; ++i) {
      const auto verdict = sample(current_a, rpm, told);
      if (verdict == Verdict::kRests) continue;
      last = verdict;
      if (came_after == 0) came_after = i + 1;
    }
    return last;
  }
  Verdict sample(float current_a, float rpm, bool told = true, Duration spacing = 1ms) {
    feedback.received += spacing;
    ++feedback.samples;
    feedback.current_a = current_a;
    feedback.velocity_rpm = rpm;
    return check.step(feedback, told, kStandstillRpm);
  }

  RestCheck check{kConfig};
  MotorFeedback feedback{.received = MonotonicTime{1s}};
  int came_after = 0;
};

TEST_F(RestCheckTest, ACurrentAlongTheMotionForSoLongIsTorque) {
  run(20, 8.0F, 300.0F, false);  // as it was driven
  EXPECT_EQ(run(300, 1.5F, 200.0F), Verdict::kDriven);
  EXPECT_EQ(came_after, 102) << "101 samples span 100 ms; the first comes with the order";
}

TEST_F(RestCheckTest, ADriveThatDrivesBackwardsIsFoundToo) {
  EXPECT_EQ(run(300, -1.5F, -200.0F), Verdict::kDriven);
}

TEST_F(RestCheckTest, ACurrentAtStandstillIsTorque) {
  EXPECT_EQ(run(300, 1.5F, 0.0F), Verdict::kDriven);
  check = RestCheck{kConfig};
  EXPECT_EQ(run(300, -1.5F, 9.0F), Verdict::kDriven) << "whichever way it creeps";
}

TEST_F(RestCheckTest, AWheelThatCoastsDownOrIsBrakedByItsShortedWindingRests) {
  for (float rpm = 300.0F; rpm > 15.0F; rpm -= 0.5F) EXPECT_EQ(sample(-3.0F, rpm), Verdict::kRests);
  EXPECT_EQ(run(2000, 0.0F, 5.0F), Verdict::kRests);
}

TEST_F(RestCheckTest, WithinTheTimeOfACommandThatIsOnItsWayItRests) {
  EXPECT_EQ(run(99, 8.0F, 300.0F), Verdict::kRests);
  EXPECT_EQ(run(1000, 0.2F, 300.0F), Verdict::kRests);
}

TEST_F(RestCheckTest, NoiseChangesItsSignAndIsNoTorque) {
  for (int i = 0; i < 5000; ++i) EXPECT_EQ(sample(i % 60 < 30 ? 1.4F : -1.4F, 0.0F), Verdict::kRests);
  EXPECT_EQ(run(5000, 0.9F, 0.0F), Verdict::kRests) << "an offset below the threshold";
}

TEST_F(RestCheckTest, AHandAndGravityAreToldAndNoMore) {
  for (int turn = 0; turn < 2; ++turn) {
    int told = 0;
    for (float rpm = 0.0F; rpm < 400.0F; rpm += 0.4F)
      told += sample(0.0F, rpm) == Verdict::kGainsSpeed ? 1 : 0;
    EXPECT_EQ(told, 1) << "once for each time";
    for (float rpm = 400.0F; rpm > 0.0F; rpm -= 0.4F) EXPECT_EQ(sample(0.0F, rpm), Verdict::kRests);
  }
}

TEST_F(RestCheckTest, SpeedFromBeforeIsNotGained) { EXPECT_EQ(run(3000, 0.0F, 400.0F), Verdict::kRests); }

TEST_F(RestCheckTest, ItIsToldOnceUntilItRests) {
  EXPECT_EQ(run(150, 2.0F, 0.0F), Verdict::kDriven);
  EXPECT_EQ(run(3000, 2.0F, 0.0F), Verdict::kRests);
  EXPECT_EQ(run(10, 0.0F, 0.0F), Verdict::kRests);
  EXPECT_EQ(run(150, 2.0F, 0.0F), Verdict::kDriven);
  check.reset();
  EXPECT_EQ(run(150, 2.0F, 0.0F), Verdict::kDriven) << "or its fault was cleared";
}

TEST_F(RestCheckTest, WhatItIsToldToDoIsNone) {
  EXPECT_EQ(run(5000, 8.0F, 300.0F, false), Verdict::kRests);
  EXPECT_EQ(run(60, 8.0F, 300.0F), Verdict::kRests);
  EXPECT_EQ(run(5, 8.0F, 300.0F, false), Verdict::kRests);
  EXPECT_EQ(run(60, 8.0F, 300.0F), Verdict::kRests) << "the time begins anew";
}

TEST_F(RestCheckTest, TwoSamplesAreNoEvidenceHoweverFarApart) {
  sample(0.0F, 0.0F);
  EXPECT_EQ(sample(8.0F, 0.0F, true, 1s), Verdict::kRests);
  EXPECT_EQ(sample(8.0F, 0.0F, true, 1s), Verdict::kRests);
  EXPECT_EQ(sample(8.0F, 0.0F, true, 1s), Verdict::kDriven);
}

TEST_F(RestCheckTest, ASampleIsCountedOnce) {
  sample(0.0F, 0.0F);
  sample(8.0F, 0.0F);
  feedback.received += 10s;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(check.step(feedback, true, kStandstillRpm), Verdict::kRests);
}

TEST_F(RestCheckTest, WhatADriveDoesNotReportIsNoEvidence) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(run(500, kNan, 300.0F), Verdict::kRests);
  EXPECT_EQ(run(500, 8.0F, kNan), Verdict::kRests);
  check = RestCheck{{.current_a = 0.0F, .time = 100ms}};
  EXPECT_EQ(run(5000, 20.0F, 300.0F), Verdict::kRests) << "not watched";
}

TEST_F(RestCheckTest, AtItsThresholdsAReadingIsNoEvidence) {
  EXPECT_EQ(run(300, kConfig.current_a, 0.0F), Verdict::kRests);
  EXPECT_EQ(run(300, -2.0F, kStandstillRpm), Verdict::kRests) << "it turns, and the current brakes";
  EXPECT_EQ(run(300, -2.0F, kStandstillRpm - 0.1F), Verdict::kDriven);
  check = RestCheck{{.current_a = 1.0F, .time = 100ms}};
  EXPECT_EQ(run(300, 2.0F, 0.0F), Verdict::kDriven);
  EXPECT_EQ(run(300, 0.0F, 500.0F), Verdict::kRests) << "gained speed is nobody's business here";
}

TEST_F(RestCheckTest, GainedSpeedCountsFromTheSlowest) {
  EXPECT_EQ(run(2, 0.0F, 80.0F), Verdict::kRests);
  EXPECT_EQ(run(1, 0.0F, -30.0F), Verdict::kRests);
  EXPECT_EQ(run(1, 0.0F, 80.0F), Verdict::kRests) << "50 rpm, no more";
  EXPECT_EQ(run(1, 0.0F, -80.5F), Verdict::kGainsSpeed);
  EXPECT_EQ(run(1, 0.0F, kStandstillRpm), Verdict::kRests);
  EXPECT_EQ(run(1, 0.0F, 90.0F), Verdict::kRests) << "it has not stood still";
  EXPECT_EQ(run(1, 0.0F, 9.0F), Verdict::kRests);
  EXPECT_EQ(run(1, 0.0F, 90.0F), Verdict::kGainsSpeed);
  check.reset();
  EXPECT_EQ(run(5, 0.0F, 90.0F), Verdict::kRests) << "the speed that it has is none that it gained";
  EXPECT_EQ(run(1, 0.0F, 150.0F), Verdict::kGainsSpeed);
}

TEST_F(RestCheckTest, ASpeedThatWasNotReportedAtFirstIsTakenWhenItIs) {
  run(3, 0.0F, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(run(3, 0.0F, 100.0F), Verdict::kRests);
  EXPECT_EQ(run(1, 0.0F, 151.0F), Verdict::kGainsSpeed);
}

TEST_F(RestCheckTest, ACurrentThatChangesItsSignBeginsItsTimeAnew) {
  EXPECT_EQ(run(90, 2.0F, 0.0F), Verdict::kRests);
  EXPECT_EQ(run(100, -2.0F, 0.0F), Verdict::kRests);
  EXPECT_EQ(run(1, -2.0F, 0.0F), Verdict::kDriven);
  EXPECT_EQ(run(50, 2.0F, 0.0F), Verdict::kRests) << "no rest between: it is told";
}

}  // namespace
}  // namespace rc10::test::rest_check_test
