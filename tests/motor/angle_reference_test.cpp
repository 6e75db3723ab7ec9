#include "motor/angle_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rc10::angle_reference_test {
namespace {

TEST(AngleReference, IsUnknownUntilSomebodySetsIt) {
  AngleReference reference({});
  EXPECT_FALSE(reference.setZero(0.0)) << "there is no position yet";
  reference.update(700.0);
  EXPECT_FALSE(reference.known());
  EXPECT_EQ(reference.totalAngleDeg(), 0.0);
  EXPECT_TRUE(reference.setZero(30.0));
  EXPECT_TRUE(reference.known());
  reference.update(710.0);
  EXPECT_EQ(reference.totalAngleDeg(), 40.0);
  EXPECT_EQ(reference.positionFor(30.0), 700.0);
}

TEST(AngleReference, RefusesAZeroThatIsNoNumber) {
  AngleReference reference({});
  reference.update(1.0);
  EXPECT_FALSE(reference.setZero(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(reference.known());
}

TEST(AngleReference, AnAbsoluteEncoderReadsItsZeroAnglesWithinHalfATurn) {
  AngleReference reference({.absolute = true, .zero_deg = 30.0});
  reference.update(350.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), -40.0);
  EXPECT_DOUBLE_EQ(reference.positionFor(0.0), 390.0);
}

TEST(AngleReference, TheZeroForTheFileKeepsAnAngleOverARestartHoweverOftenItWasSet) {
  AngleReference before({.absolute = true, .zero_deg = 20.0});
  EXPECT_TRUE(std::isnan(before.zeroForFile())) << "there is no position yet";
  before.update(350.0);
  EXPECT_DOUBLE_EQ(before.zeroForFile(), 20.0);
  ASSERT_TRUE(before.setZero(50.0));
  before.update(370.0);
  ASSERT_TRUE(before.setZero(-70.0));
  AngleReference after({.absolute = true, .zero_deg = before.zeroForFile()});
  after.update(10.0);  // within the turn, as its drive starts
  EXPECT_DOUBLE_EQ(after.totalAngleDeg(), -70.0);
  AngleReference counted({});
  counted.update(350.0);
  EXPECT_TRUE(std::isnan(counted.zeroForFile())) << "no file keeps it";
}

TEST(AngleReference, TheFirstPositionIsZeroIfTheConfigurationSaysSo) {
  AngleReference reference({.absolute = true, .zero_deg = 30.0, .zero_at_power_on = true});
  reference.update(350.0);
  EXPECT_TRUE(reference.known());
  EXPECT_EQ(reference.totalAngleDeg(), 0.0);
}

TEST(AngleReference, ALostReferenceGoesOnWithoutAJump) {
  AngleReference reference({.zero_at_power_on = true});
  reference.update(10.0);
  reference.update(20.0);
  reference.lose();
  EXPECT_FALSE(reference.known());
  reference.update(21.0);
  EXPECT_FALSE(reference.known()) << "power-on is over";
  EXPECT_EQ(reference.totalAngleDeg(), 11.0);
}

TEST(AngleReference, AnAbsoluteEncoderFindsItsReferenceAgain) {
  AngleReference reference({.absolute = true});
  reference.update(10.0);
  reference.update(370.0);
  EXPECT_EQ(reference.totalAngleDeg(), 370.0);
  reference.lose();
  EXPECT_FALSE(reference.known());
  reference.update(371.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 11.0);
}

TEST(AngleReference, OneThatIsForgottenStaysUnknownUntilItIsSetThoughItsEncoderIsAbsolute) {
  AngleReference reference({.absolute = true});
  reference.update(30.0);
  reference.forget();
  reference.update(40.0);
  EXPECT_FALSE(reference.known());
  EXPECT_EQ(reference.totalAngleDeg(), 40.0) << "without a jump";
  EXPECT_TRUE(reference.setZero(0.0));
  EXPECT_TRUE(reference.known());
  reference.forget();
  reference.lose();  // its drive was restarted
  reference.update(50.0);
  EXPECT_TRUE(reference.known());
  EXPECT_EQ(reference.totalAngleDeg(), 50.0);
}

TEST(AngleReference, AShaftThatMayHaveBeenTurnedIsWhereItsTravelSays) {
  AngleReference arm({.absolute = true, .travel = {-90.0, 200.0}});
  arm.update(-145.0);
  EXPECT_DOUBLE_EQ(arm.totalAngleDeg(), 215.0);
  arm.doubtTurn();
  EXPECT_FALSE(arm.known());
  arm.update(-110.0);
  EXPECT_TRUE(arm.known());
  EXPECT_DOUBLE_EQ(arm.totalAngleDeg(), -110.0) << "250 is beyond its travel";
  AngleReference wheel({.absolute = true});
  wheel.update(10.0);
  wheel.update(730.0);
  wheel.doubtTurn();
  wheel.update(731.0);
  EXPECT_TRUE(wheel.known());
  EXPECT_EQ(wheel.totalAngleDeg(), 731.0);
}

TEST(AngleReference, AnAbsoluteAngleThatIsFollowedGoesOnWithoutItsReference) {
  AngleReference reference({.absolute = true});
  reference.update(10.0);
  reference.update(730.0, false, false);
  reference.lose();
  reference.update(731.0, false, false);
  EXPECT_FALSE(reference.known());
  EXPECT_EQ(reference.totalAngleDeg(), 731.0) << "no leap of two turns";
  reference.update(731.0, false, true);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 11.0);
}

}  // namespace
}  // namespace rc10::angle_reference_test
