#include "client/motion/abort_criteria.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>

namespace rc10::client::test::abort_criteria_test {
namespace {

using testing::HasSubstr;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr AbortCriteria kCriteria{.angle_min_deg = -30.0,
                                  .angle_max_deg = 90.0,
                                  .velocity_max_rpm = 100.0,
                                  .current_max_a = 3.0,
                                  .feedback_age_max_us = 50'000.0,
                                  .limits_abort = true};
// The motor stands at 500 degrees.
constexpr double kStartDeg = 500.0;
constexpr CurveSample kGood{
    .total_angle_deg = 510.0, .velocity_rpm = -99.0, .current_a = -2.9, .feedback_age_us = 900.0};

Excitation step(double amplitude) { return *Excitation::of({.amplitude = amplitude, .time_s = 1.0}); }

std::string refusal(const AbortCriteria& criteria, double amplitude, ControlMode mode) {
  const auto fit = admits(criteria, step(amplitude), mode);
  return fit ? "" : fit.error().message;
}

Abort judged(CurveSample sample) {
  const auto found = judge(kCriteria, sample, kStartDeg);
  EXPECT_TRUE(found);
  return found.value_or(Abort{});
}

template <typename Change>
Abort after(const Change& change) {
  CurveSample sample = kGood;
  change(sample);
  return judged(sample);
}

TEST(AbortCriteria, ASampleWithinThemGoesOn) { EXPECT_FALSE(judge(kCriteria, kGood, kStartDeg)); }

TEST(AbortCriteria, TheCorridorCountsFromTheStart) {
  const auto above = after([](auto& s) { s.total_angle_deg = 591.0; });
  EXPECT_EQ(above.criterion, Criterion::kAngle);
  EXPECT_EQ(above.value, 91.0);
  EXPECT_EQ(above.limit, 90.0);
  EXPECT_EQ(above.text,
            "angle from the start 91.00 deg beyond 90.00 deg: a smaller amplitude, lower gains, or a wider "
            "corridor");
  EXPECT_EQ(after([](auto& s) { s.total_angle_deg = 469.0; }).limit, -30.0);
}

TEST(AbortCriteria, SpeedAndCurrentAreBoundedBothWays) {
  const auto fast = after([](auto& s) { s.velocity_rpm = -101.0; });
  EXPECT_EQ(fast.criterion, Criterion::kVelocity);
  EXPECT_EQ(fast.limit, -100.0);
  const auto strong = after([](auto& s) { s.current_a = 3.1; });
  EXPECT_EQ(strong.criterion, Criterion::kCurrent);
  EXPECT_THAT(strong.text, HasSubstr("current 3.10 A beyond 3.00 A: "));
}

TEST(AbortCriteria, OldFeedbackEndsTheTest) {
  const auto old = after([](auto& s) { s.feedback_age_us = 51'000.0; });
  EXPECT_EQ(old.criterion, Criterion::kFeedbackAge);
  EXPECT_EQ(old.value, 51.0);
  EXPECT_EQ(old.limit, 50.0);
  EXPECT_EQ(after([](auto& s) { s.feedback_age_us = -1.0; }).criterion, Criterion::kFeedbackAge);  // never
}

TEST(AbortCriteria, ALimitThatActsIsNamed) {
  const auto limited = after([](auto& s) { s.limits = kLimitCurrent | kLimitSlew; });
  EXPECT_EQ(limited.criterion, Criterion::kLimit);
  EXPECT_THAT(limited.text, HasSubstr("(current,slew)"));
  AbortCriteria lenient = kCriteria;
  lenient.limits_abort = false;
  CurveSample sample = kGood;
  sample.limits = kLimitCurrent;
  EXPECT_FALSE(judge(lenient, sample, kStartDeg));
}

TEST(AbortCriteria, AReadingThatIsMissingMeetsNoLimit) {
  EXPECT_EQ(after([](auto& s) { s.total_angle_deg = kNoNumber; }).criterion, Criterion::kAngle);
  EXPECT_EQ(after([](auto& s) { s.velocity_rpm = kNoNumber; }).criterion, Criterion::kVelocity);
  EXPECT_THAT(after([](auto& s) { s.current_a = kNoNumber; }).text,
              HasSubstr("current is not reported, and has a limit of 3.00 A"));
  AbortCriteria open{.current_max_a = 3.0};  // no corridor, no speed
  CurveSample sample = kGood;
  sample.total_angle_deg = sample.velocity_rpm = kNoNumber;
  EXPECT_FALSE(judge(open, sample, kNoNumber));
}

TEST(AbortCriteria, ATargetBeyondThemIsRefusedBeforeAnythingMoves) {
  EXPECT_EQ(refusal(kCriteria, 100.0, ControlMode::kVelocity), "");
  EXPECT_THAT(refusal(kCriteria, 101.0, ControlMode::kVelocity), HasSubstr("higher limit of the speed"));
  EXPECT_THAT(refusal(kCriteria, -31.0, ControlMode::kTotalAngle), HasSubstr("from -31.00 to 0.00 deg"));
  EXPECT_THAT(refusal(kCriteria, 3.1, ControlMode::kCurrent), HasSubstr("higher limit of the current"));
}

TEST(AbortCriteria, ALimitThatIsNoneIsRefused) {
  const auto with = [](auto member, double value) {
    AbortCriteria criteria = kCriteria;
    criteria.*member = value;
    return refusal(criteria, 1.0, ControlMode::kVelocity);
  };
  EXPECT_THAT(with(&AbortCriteria::current_max_a, 0.0), HasSubstr("current has no limit"));
  EXPECT_THAT(with(&AbortCriteria::current_max_a, kNoNumber), HasSubstr("current has no limit"));
  EXPECT_THAT(with(&AbortCriteria::velocity_max_rpm, -1.0), HasSubstr("speed has no limit"));
  EXPECT_THAT(with(&AbortCriteria::angle_min_deg, 1.0), HasSubstr("outside of its corridor"));
  EXPECT_THAT(with(&AbortCriteria::feedback_age_max_us, 0.0), HasSubstr("age of feedback"));
  EXPECT_THAT(refusal(kCriteria, 1.0, ControlMode::kDuty), HasSubstr("no reading follows"));
}

}  // namespace
}  // namespace rc10::client::test::abort_criteria_test
