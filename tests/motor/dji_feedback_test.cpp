#include <cmath>
#include <initializer_list>
#include <limits>

#include <gtest/gtest.h>

#include "support/dji_frames.hpp"

namespace rc10::test::dji_feedback_test {
namespace {

using std::chrono::milliseconds;

MotorSettings reversed(MotorSettings config) {
  config.direction = -1;
  return config;
}

TEST(DjiFeedback, NothingIsKnownBeforeTheFirstFrame) {
  const DJI_Motor motor(djiConfig(kM3508));
  EXPECT_EQ(motor.feedback().samples, 0U);
  EXPECT_TRUE(std::isnan(motor.getRPM().value));
  EXPECT_TRUE(std::isnan(motor.getTotalAngle().value));
  EXPECT_FALSE(motor.feedback().zeroed);
}

TEST(DjiFeedback, IsConvertedToTheOutputShaftOnReceipt) {
  DJI_Motor motor(djiConfig(kM3508));
  DjiFeeder feeder(motor);
  ASSERT_EQ(feeder.feed({.position = 100, .rpm = 3000, .current = 8192, .temperature_c = 61}),
            FrameVerdict::kAccepted);
  EXPECT_NEAR(motor.getRPM().value, 3000.0 * 187.0 / 3591.0, 1e-4);
  EXPECT_NEAR(motor.getCurrent().value, 10.0, 1e-6);
  EXPECT_NEAR(motor.feedback().torque_nm, 3.0F, 1e-5F);
  EXPECT_FLOAT_EQ(motor.feedback().temperature_c, 61.0F);
  EXPECT_TRUE(std::isnan(motor.feedback().voltage_v));
  EXPECT_EQ(motor.feedback().samples, 1U);
}

TEST(DjiFeedback, DirectionTurnsEverySignAround) {
  DJI_Motor motor(reversed(djiConfig(kM2006)));
  DjiFeeder feeder(motor);
  (void)feeder.feed({.position = 0, .rpm = 3600, .current = 1000});
  (void)feeder.feed({.position = 491, .rpm = 3600, .current = 1000});
  EXPECT_NEAR(motor.getRPM().value, -100.0, 1e-4);
  EXPECT_NEAR(motor.getCurrent().value, -1.0, 1e-6);
  EXPECT_NEAR(motor.feedback().torque_nm, -0.18F, 1e-6F);
  EXPECT_NEAR(motor.getTotalAngle().value, -491.0 * 360.0 / 8192.0 / 36.0, 1e-9);
  EXPECT_NEAR(motor.getAngle().value, 360.0 - 491.0 * 360.0 / 8192.0 / 36.0, 1e-4);
}

TEST(DjiFeedback, AConfiguredGearRatioReplacesTheModelsOwn) {
  MotorSettings config = djiConfig(kM3508);
  config.gear_ratio = 1.0;
  DJI_Motor motor(config);
  DjiFeeder feeder(motor);
  (void)feeder.feed({.rpm = 1000, .current = 16384});
  EXPECT_DOUBLE_EQ(motor.get_GearRatio(), 1.0);
  EXPECT_NEAR(motor.getRPM().value, 1000.0, 1e-6);
  EXPECT_NEAR(motor.feedback().torque_nm, 20.0F * 0.015622F, 1e-4F);
}

TEST(DjiFeedback, C610ReportsNoTemperature) {
  DJI_Motor motor(djiConfig(kM2006));
  DjiFeeder feeder(motor);
  (void)feeder.feed({.temperature_c = 45});
  EXPECT_TRUE(std::isnan(motor.feedback().temperature_c));
}

TEST(DjiFeedback, EveryReportedValueDecodesToItself) {
  for (const DjiModel* model : djiModels()) {
    DJI_Motor motor(djiConfig(*model));
    DjiFeeder feeder(motor);
    for (int raw = -32768; raw <= 32767; raw += 7) {
      const auto value = static_cast<std::int16_t>(raw);
      ASSERT_EQ(feeder.feed({.position = 0, .rpm = value, .current = value}), FrameVerdict::kAccepted);
      ASSERT_EQ(std::lround(motor.getRPM().value * model->gear_ratio), raw);
      const double counts_per_a =
          model->feedback_raw_full_scale / static_cast<double>(model->feedback_full_scale_a);
      ASSERT_EQ(std::lround(motor.getCurrent().value * counts_per_a), raw);
    }
  }
}

TEST(DjiFeedback, EveryPositionOfAnAbsoluteEncoderDecodesToItself) {
  for (const int direction : {1, -1}) {
    MotorSettings config = djiConfig(kGM6020);
    config.direction = direction;
    DJI_Motor motor(config);
    DjiFeeder feeder(motor);
    for (std::uint16_t position = 0; position < 8192; ++position) {
      ASSERT_EQ(feeder.feed({.position = position}), FrameVerdict::kAccepted);
      const double expected = std::fmod(direction * position * 360.0 / 8192.0 + 360.0, 360.0);
      ASSERT_NEAR(motor.getAngle().value, expected, 1e-4);
      ASSERT_GE(motor.getAngle().value, 0.0);
      ASSERT_LT(motor.getAngle().value, 360.0);
    }
  }
}

TEST(DjiFeedback, AnythingButEightDataBytesOfAClassicFrameIsMalformedAndChangesNothing) {
  DJI_Motor motor(djiConfig(kM3508));
  const CanFrame good = makeDjiFeedback(kM3508, 1, {.position = 5, .rpm = 19});
  ASSERT_EQ(motor.updateFeedback(good), FrameVerdict::kAccepted);
  for (const int length : {0, 1, 7, 9, 12, 64}) {
    CanFrame frame = makeDjiFeedback(kM3508, 1, {.position = 77, .rpm = 500});
    frame.length = static_cast<std::uint8_t>(length);
    EXPECT_EQ(motor.updateFeedback(frame), FrameVerdict::kMalformed) << length;
  }
  CanFrame fd = good;
  fd.fd = true;
  EXPECT_EQ(motor.updateFeedback(fd), FrameVerdict::kMalformed);
  CanFrame remote = good;
  remote.type = FrameType::kRemote;
  EXPECT_EQ(motor.updateFeedback(remote), FrameVerdict::kMalformed);
  EXPECT_EQ(motor.updateFeedback(makeDjiFeedback(kM3508, 1, {.position = 8192, .rpm = 500})),
            FrameVerdict::kMalformed);
  EXPECT_EQ(motor.feedback().samples, 1U);
  EXPECT_NEAR(motor.getRPM().value, 19.0 * 187.0 / 3591.0, 1e-5);
}

TEST(DjiFeedback, BelongsToAMotorByIdAmongTheClassicStandardFrames) {
  const DJI_Motor motor(djiConfig(kGM6020, 7));
  CanFrame frame = makeDjiFeedback(kGM6020, 7, {});
  EXPECT_EQ(frame.id.value, 0x20BU);
  EXPECT_TRUE(motor.matchesFrame(frame));
  EXPECT_TRUE(accepts(motor.filters().front(), frame));
  EXPECT_FALSE(motor.matchesFrame(makeDjiFeedback(kGM6020, 6, {})));
  frame.id.extended = true;
  EXPECT_FALSE(motor.matchesFrame(frame));
  frame.id.extended = false;
  frame.fd = true;
  EXPECT_FALSE(motor.matchesFrame(frame));
}

TEST(DjiReference, AGearedMotorCountsFromItsFirstSampleAndIsNotZeroed) {
  DJI_Motor motor(djiConfig(kM3508));
  DjiFeeder feeder(motor);
  EXPECT_FALSE(motor.setZero(0.0));  // nothing is known yet
  (void)feeder.feed({.position = 4000});
  EXPECT_FALSE(motor.feedback().zeroed);
  EXPECT_DOUBLE_EQ(motor.getTotalAngle().value, 0.0);
  EXPECT_FALSE(motor.setZero(std::numeric_limits<double>::quiet_NaN()));
  ASSERT_TRUE(motor.setZero(400.0));
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_DOUBLE_EQ(motor.getTotalAngle().value, 400.0);
  EXPECT_NEAR(motor.getAngle().value, 40.0, 1e-5);
}

TEST(DjiReference, AnAngleJustBelowAFullTurnIsNotRoundedUpToIt) {
  DJI_Motor motor(djiConfig(kM3508));
  DjiFeeder(motor).feed({});
  for (const double angle_deg : {-1e-9, 359.9999999, 720.0 - 1e-9}) {
    ASSERT_TRUE(motor.setZero(angle_deg));
    EXPECT_LT(motor.feedback().angle_deg, 360.0F) << angle_deg;
    EXPECT_GE(motor.feedback().angle_deg, 0.0F) << angle_deg;
  }
}

TEST(DjiReference, ZeroAtPowerOnMakesTheFirstPositionZero) {
  for (const DjiModel* model : djiModels()) {
    MotorSettings config = djiConfig(*model);
    config.zero_at_power_on = true;
    DJI_Motor motor(config);
    DjiFeeder feeder(motor);
    (void)feeder.feed({.position = 4000});
    EXPECT_TRUE(motor.feedback().zeroed);
    EXPECT_DOUBLE_EQ(motor.getTotalAngle().value, 0.0);
  }
}

TEST(DjiReference, AGapTooLongToCountTheTurnsIsNotZeroedUntilSetAgain) {
  DJI_Motor motor(djiConfig(kM2006));
  DjiFeeder feeder(motor);
  (void)feeder.feed({});
  ASSERT_TRUE(motor.setZero(0.0));
  (void)feeder.feed({.position = 100}, milliseconds{kM2006.countable_lost_frames + 1});
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_EQ(motor.feedback().losses, 0U);
  (void)feeder.feed({.position = 100}, milliseconds{100});
  EXPECT_FALSE(motor.feedback().zeroed);
  EXPECT_EQ(motor.feedback().losses, 1U);
  (void)feeder.feed({.position = 100});
  feeder.tick();
  EXPECT_FALSE(motor.feedback().zeroed);
  (void)feeder.feed({.position = 100}, milliseconds{100});
  EXPECT_EQ(motor.feedback().losses, 1U) << "there was none to lose";
  ASSERT_TRUE(motor.setZero(90.0));
  (void)feeder.feed({.position = 100});
  EXPECT_TRUE(motor.feedback().zeroed);
}

TEST(DjiReference, AnAbsoluteEncoderIsZeroedFromTheFirstSampleWithinHalfATurn) {
  MotorSettings config = djiConfig(kGM6020);
  config.zero_deg = 10.0;
  DJI_Motor motor(config);
  DjiFeeder feeder(motor);
  (void)feeder.feed({.position = 0});
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.getTotalAngle().value, -10.0, 1e-9);
  EXPECT_NEAR(motor.getAngle().value, 350.0, 1e-4);
}

TEST(DjiReference, TheZeroOfAReversedAbsoluteEncoderIsTheAngleItUsedToRead) {
  MotorSettings config = reversed(djiConfig(kGM6020));
  DJI_Motor before(config);
  DjiFeeder(before).feed({.position = 2048});
  config.zero_deg = before.getAngle().value;
  ASSERT_GT(config.zero_deg, 1.0);
  DJI_Motor after(config);
  DjiFeeder(after).feed({.position = 2048});
  EXPECT_NEAR(after.getTotalAngle().value, 0.0, 1e-4);
}

TEST(DjiReference, TheZeroForTheFileKeepsAnAngleOverARestartHoweverOftenItWasSet) {
  for (const bool turned_round : {false, true}) {
    MotorSettings config = djiConfig(kGM6020);
    if (turned_round) config.direction = -1;
    config.zero_deg = 20.0;
    DJI_Motor before(config);
    EXPECT_TRUE(std::isnan(before.zeroForFile())) << "nothing was heard yet";
    DjiFeeder feeder(before);
    (void)feeder.feed({.position = 1000});
    EXPECT_NEAR(before.zeroForFile(), 20.0, 1e-9);
    before.setZero(50.0);
    (void)feeder.feed({.position = 1500});
    before.setZero(-70.0);
    config.zero_deg = before.zeroForFile();
    DJI_Motor after(config);
    DjiFeeder(after).feed({.position = 1500});
    EXPECT_NEAR(after.getTotalAngle().value, -70.0, 1e-9);
  }
}

TEST(DjiReference, AGearedMotorHasNoZeroForTheFile) {
  DJI_Motor motor(djiConfig(kM3508));
  DjiFeeder(motor).feed({.position = 1000});
  EXPECT_TRUE(std::isnan(motor.zeroForFile()));
}

TEST(DjiReference, AfterALongGapAnAbsoluteEncoderIsOnTheTurnNearestToWhereItWas) {
  DJI_Motor motor(djiConfig(kGM6020));
  DjiFeeder feeder(motor);
  for (int i = 0; i < 400; ++i)
    (void)feeder.feed({.position = static_cast<std::uint16_t>(i * 43 % 8192), .rpm = 315});
  EXPECT_NEAR(motor.getTotalAngle().value, 399 * 43 * 360.0 / 8192.0, 1e-6);  // two turns
  (void)feeder.feed({.position = 1024}, milliseconds{500});
  EXPECT_NEAR(motor.getAngle().value, 45.0, 1e-3);
  feeder.tick();
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.getTotalAngle().value, 2 * 360.0 + 45.0, 1e-6);
}

TEST(DjiReference, AZeroOfPowerOnIsNotFoundAgainAfterAGap) {
  auto settings = djiConfig(kGM6020);
  settings.zero_at_power_on = true;
  DJI_Motor motor(settings);
  DjiFeeder feeder(motor);
  feeder.feedAndTick({.position = 1024});
  ASSERT_TRUE(motor.feedback().zeroed);
  (void)feeder.feed({.position = 1024}, milliseconds{500});
  feeder.tick();
  EXPECT_FALSE(motor.feedback().zeroed) << "as in each family";
}

TEST(DjiReference, AnAbsoluteEncoderNeverJumpsWhileItsAngleIsControlledOrHeld) {
  for (const auto kind : {FrameKind::kCommand, FrameKind::kHold}) {
    DJI_Motor motor(djiConfig(kGM6020));
    DjiFeeder feeder(motor);
    feeder.feedAndTick({.position = 0});
    ASSERT_TRUE(motor.setZero(720.0));
    motor.order(kind);
    ASSERT_TRUE(motor.setTargetTotalAngle(Degrees{720.0}));
    feeder.feedAndTick({.position = 0});
    (void)feeder.feed({.position = 91}, milliseconds{60});
    feeder.tick();
    EXPECT_NEAR(motor.getTotalAngle().value, 724.0, 0.01);
    EXPECT_TRUE(motor.feedback().zeroed) << "found again without a leap";
    EXPECT_EQ(motor.feedback().losses, 1U) << "but it is told: the supervisor ends the target";
  }
}

TEST(DjiReference, WithATravelAnAbsoluteEncoderIsOnItsTurnAgain) {
  auto settings = djiConfig(kGM6020);
  settings.travel = {.min_deg = -90.0, .max_deg = 200.0};
  DJI_Motor motor(settings);
  DjiFeeder feeder(motor);
  feeder.feedAndTick({.position = 8192 - 2048});  // 270 deg: -90
  EXPECT_NEAR(motor.getTotalAngle().value, -90.0, 0.01);
  (void)feeder.feed({.position = 4096}, milliseconds{500});
  feeder.tick();
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.getTotalAngle().value, 180.0, 0.01) << "-180 is nearer, but beyond it";
}

TEST(DjiReference, AGearedGM6020IsNotAbsolute) {
  MotorSettings config = djiConfig(kGM6020);
  config.gear_ratio = 2.0;
  DJI_Motor motor(config);
  DjiFeeder(motor).feed({.position = 4096});
  EXPECT_FALSE(motor.feedback().zeroed);
}

TEST(DjiReference, AnglesKeepTheirPrecisionAfterABillionTurns) {
  // A drive whose limits allow one sample a minute, so that the turns can be reached.
  DjiModel model = kM2006;
  model.encoder = {.counts_per_turn = 8192, .max_velocity_rpm = 32'000.0F};
  DJI_Motor motor(djiConfig(model), model);
  DjiFeeder feeder(motor);
  (void)feeder.feed({.position = 7, .rpm = 30'000});
  for (int i = 0; i < 36'000; ++i) (void)feeder.feed({.position = 7, .rpm = 30'000}, std::chrono::minutes{1});
  EXPECT_NEAR(motor.getTotalAngle().value, 36'000.0 * 30'000.0 / 36.0 * 360.0, 1e-5);
  const double before = motor.getTotalAngle().value;
  (void)feeder.feed({.position = 8, .rpm = 0}, milliseconds{0});
  EXPECT_NEAR(motor.getTotalAngle().value - before, 360.0 / 8192.0 / 36.0, 1e-5);
}

}  // namespace
}  // namespace rc10::test::dji_feedback_test
