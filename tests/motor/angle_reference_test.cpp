#include "motor/angle_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rc10::angle_reference_test {
namespace {

/// An absolute one that was at 370 deg, on its second turn, when its drive lost them.
AngleReference lostOnItsSecondTurn() {
  AngleReference reference({.absolute = true});
  reference.update(10.0);
  reference.update(370.0);
  EXPECT_EQ(reference.totalAngleDeg(), 370.0);
  reference.lose();
  EXPECT_FALSE(reference.known());
  return reference;
}

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

TEST(AngleReference, AnAbsoluteEncoderFindsItsReferenceAgainOnTheTurnNearestToWhereItWas) {
  auto reference = lostOnItsSecondTurn();
  reference.update(371.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 371.0);
  reference.update(731.0);
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 731.0) << "it is found once";
  reference.lose();
  reference.update(-100.0);  // its drive was restarted
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 620.0);
  EXPECT_DOUBLE_EQ(reference.positionFor(620.0), -100.0);
}

TEST(AngleReference, ACountWhoseTurnsAreUnknownTellsNoAngleAndItsLeapsAreNoWay) {
  AngleReference reference({.absolute = true});
  reference.drift(-134.0);  // ten wraps of 1432 deg from where the drive counts it
  EXPECT_FALSE(reference.known());
  EXPECT_FALSE(reference.setZero(0.0));
  reference.update(14'550.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 150.0) << "it begins within half a turn";
  reference.lose();
  reference.drift(-134.0);
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 150.0);
  reference.drift(-124.0);
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 160.0);
  reference.lose();
  reference.drift(300.0);
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 160.0) << "another leap";
  EXPECT_FALSE(reference.known());
  reference.update(14'560.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 160.0);
  AngleReference counted({});
  counted.update(5.0);
  counted.lose();
  counted.drift(300.0);
  counted.drift(310.0);
  counted.lose();  // it counts from elsewhere
  counted.drift(1'742.0);
  counted.update(1'742.0);
  EXPECT_DOUBLE_EQ(counted.totalAngleDeg(), 10.0) << "that of the turns neither";
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
  EXPECT_FALSE(reference.known());
  EXPECT_TRUE(reference.setZero(5.0));
  reference.lose();
  reference.update(60.0);
  EXPECT_TRUE(reference.known()) << "somebody has set it since";
}

TEST(AngleReference, OneThatIsForgottenBeforeItsFirstPositionIsUnknownToo) {
  AngleReference reference({.absolute = true, .travel = {-720.0, 720.0}});
  reference.forget();
  reference.update(30.0);
  EXPECT_FALSE(reference.known());
  EXPECT_FALSE(reference.turnUnclear());
}

TEST(AngleReference, ALossReturnsInTheFrameOfTheLastZero) {
  AngleReference arm({.absolute = true, .zero_deg = 5.0, .travel = {-10.0, 100.0}});
  arm.update(42.0);
  ASSERT_TRUE(arm.setZero(0.0));  // homed where the file says 37 deg
  arm.lose();
  arm.update(402.0);  // on another turn of its drive
  EXPECT_TRUE(arm.known());
  EXPECT_DOUBLE_EQ(arm.totalAngleDeg(), 0.0);
  arm.doubtTurn();
  arm.update(-28.0);  // 70 deg back, which is beyond the travel and its gap on that side
  EXPECT_DOUBLE_EQ(arm.totalAngleDeg(), -70.0);
  arm.doubtTurn();
  arm.update(-178.0);
  EXPECT_DOUBLE_EQ(arm.totalAngleDeg(), 140.0) << "of two turns the nearer one to its travel";
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

TEST(AngleReference, AnAbsoluteAngleThatIsFollowedDoesNotLeapToTheTurnOfItsTravel) {
  AngleReference arm({.absolute = true, .travel = {-90.0, 200.0}});
  arm.update(200.0, false, false);
  arm.update(250.0, false, false);  // pushed far beyond its end
  arm.lose();
  arm.update(251.0, false, false);
  EXPECT_FALSE(arm.known());
  EXPECT_EQ(arm.totalAngleDeg(), 251.0);
  arm.update(251.0, false, true);
  EXPECT_TRUE(arm.known());
  EXPECT_DOUBLE_EQ(arm.totalAngleDeg(), -109.0);
  AngleReference wheel({.absolute = true});
  wheel.update(10.0);
  wheel.update(730.0, false, false);
  wheel.lose();
  EXPECT_FALSE(wheel.known());
  wheel.update(11.0, false, false);  // its drive was restarted
  EXPECT_TRUE(wheel.known());
  EXPECT_DOUBLE_EQ(wheel.totalAngleDeg(), 731.0) << "no leap of two turns, now or later";
}

TEST(AngleReference, AZeroThatIsSetAfterALossStays) {
  auto reference = lostOnItsSecondTurn();
  ASSERT_TRUE(reference.setZero(5.0));
  reference.update(371.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 6.0);
}

TEST(AngleReference, AnUnclearTurnEndsWithItsReference) {
  constexpr Travel kFourTurns{-720.0, 720.0};
  AngleReference forgotten({.absolute = true, .travel = kFourTurns});
  forgotten.update(10.0);
  ASSERT_TRUE(forgotten.turnUnclear());
  forgotten.forget();
  EXPECT_FALSE(forgotten.turnUnclear());
  forgotten.update(400.0);
  EXPECT_FALSE(forgotten.turnUnclear()) << "it does not begin anew";
  EXPECT_DOUBLE_EQ(forgotten.totalAngleDeg(), 400.0);
  AngleReference lost({.absolute = true, .travel = kFourTurns});
  lost.update(10.0);
  lost.lose();
  EXPECT_FALSE(lost.turnUnclear());
  lost.update(400.0);
  EXPECT_TRUE(lost.turnUnclear()) << "as at power-up";
  EXPECT_DOUBLE_EQ(lost.totalAngleDeg(), 40.0);
}

TEST(AngleReference, OneThatIsForgottenAfterALossDoesNotReturn) {
  auto reference = lostOnItsSecondTurn();
  reference.forget();
  reference.update(371.0);
  EXPECT_FALSE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 371.0);
}

TEST(AngleReference, ATurnIsDoubtedWhereBothLimitsTellIt) {
  AngleReference new_one({.absolute = true, .travel = {-90.0, 90.0}});
  new_one.doubtTurn();
  new_one.update(10.0, true, false);
  EXPECT_TRUE(new_one.known()) << "nothing was known that could be doubted";
  for (const Travel travel : {Travel{.min_deg = -90.0}, Travel{.max_deg = 90.0}}) {
    AngleReference one_limit({.absolute = true, .travel = travel});
    one_limit.update(10.0);
    one_limit.doubtTurn();
    EXPECT_TRUE(one_limit.known());
  }
  AngleReference counted({.zero_at_power_on = true, .travel = {-90.0, 90.0}});
  counted.update(10.0);
  counted.doubtTurn();
  EXPECT_FALSE(counted.known()) << "it counts only while it lives";
}

TEST(AngleReference, NoFileKeepsAZeroThatPowerOnSets) {
  AngleReference reference({.absolute = true, .zero_at_power_on = true});
  reference.update(350.0);
  EXPECT_TRUE(std::isnan(reference.zeroForFile()));
  reference.lose();
  reference.update(355.0);
  EXPECT_FALSE(reference.known()) << "power-on is over";
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 5.0);
}

}  // namespace
}  // namespace rc10::angle_reference_test
