#include "module/sensed_angle.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace rc10::test::sensed_angle_test {
namespace {

constexpr double kSilent = std::numeric_limits<double>::quiet_NaN();

TEST(SensedAngle, OfASensorThatWasNeverHeardIsTheMotors) {
  SensedAngle angle;
  EXPECT_EQ(angle.step(kSilent, 30.0), 30.0);
}

TEST(SensedAngle, GoesOnByTheMotorWhereTheSensorFellSilent) {
  SensedAngle angle;
  EXPECT_EQ(angle.step(130.0, 30.0), 130.0);
  EXPECT_EQ(angle.step(kSilent, 30.0), 130.0);
  EXPECT_EQ(angle.step(kSilent, 35.0), 135.0);
  EXPECT_EQ(angle.step(90.0, 35.0), 90.0) << "the chassis has turned meanwhile";
  EXPECT_EQ(angle.step(kSilent, 35.0), 90.0);
}

TEST(SensedAngle, AMotorThatIsNotHeardSpoilsNothing) {
  SensedAngle angle;
  (void)angle.step(130.0, 30.0);
  EXPECT_EQ(angle.step(131.0, kSilent), 131.0);
  EXPECT_EQ(angle.step(kSilent, 30.0), 130.0);
}

TEST(SensedAngle, ForgetsTheSensor) {
  SensedAngle angle;
  (void)angle.step(130.0, 30.0);
  angle.forget();
  EXPECT_EQ(angle.step(kSilent, 30.0), 30.0);
}

}  // namespace
}  // namespace rc10::test::sensed_angle_test
