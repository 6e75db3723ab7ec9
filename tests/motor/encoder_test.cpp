#include "motor/encoder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "drives/dji/dji_model.hpp"

namespace rc10::test::encoder_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr double kPeriod_s = 0.001;

/// A shaft that accelerates at random between -max and +max and never exceeds the maximum speed.
class RandomShaft {
 public:
  RandomShaft(const Encoder::Config& config, std::uint64_t seed)
      : random_(seed),
        max_velocity_(static_cast<double>(config.max_velocity_rpm) / 60.0),
        max_acceleration_(static_cast<double>(config.max_acceleration_rpm_per_s) / 60.0) {}

  void advance(double dt_s) {
    if (random_() % 4 == 0) {
      constexpr std::array<double, 5> kChoices{-1.0, 1.0, 0.0, -0.3, 0.7};
      acceleration_ = max_acceleration_ * kChoices[random_() % kChoices.size()];
    }
    const double wanted = velocity_ + acceleration_ * dt_s;
    const double next = std::clamp(wanted, -max_velocity_, max_velocity_);
    turns_ += 0.5 * (velocity_ + next) * dt_s;
    velocity_ = next;
  }
  [[nodiscard]] double uniform() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }
  [[nodiscard]] std::uint64_t below(std::uint64_t n) { return random_() % n; }
  [[nodiscard]] double turns() const { return turns_; }
  [[nodiscard]] double rpm() const { return velocity_ * 60.0; }

 private:
  std::mt19937_64 random_;
  double max_velocity_;
  double max_acceleration_;
  double acceleration_ = 0.0;
  double velocity_ = 0.0;
  double turns_ = 0.0;
};

/// Feeds `samples` samples with up to `lost` frames missing between two; returns the number of samples
/// at which the count was not exact.
int countErrors(const Encoder::Config& config, int lost, int samples, std::uint64_t seed) {
  RandomShaft shaft(config, seed);
  Encoder encoder(config);
  MonotonicTime received{};
  double time_s = 1.0;
  double slow_rpm = 0.0;    // the drive's speed report lags 2 ms behind
  std::int64_t offset = 0;  // of the first sample's turn
  int errors = 0;
  for (int sample = 0; sample < samples; ++sample) {
    const int frames = 1 + static_cast<int>(shaft.below(static_cast<std::uint64_t>(lost) + 1));
    for (int step = 0; step < 2 * frames; ++step) {
      shaft.advance(kPeriod_s / 2.0);
      slow_rpm += (shaft.rpm() - slow_rpm) * 0.5 / (2.0 + 0.5);
    }
    time_s += kPeriod_s * frames;
    const double late_s = shaft.uniform() * static_cast<double>(seconds(config.stamp_error));
    const auto stamp = MonotonicTime{Duration{static_cast<std::int64_t>((time_s + late_s) * 1e9)}};
    received = std::max(received, stamp);
    const auto counts = static_cast<std::int64_t>(std::floor(shaft.turns() * config.counts_per_turn));
    const auto raw = static_cast<std::int32_t>(((counts % 8192) + 8192) % 8192);
    const bool first = !encoder.hasSample();
    if (!encoder.update(raw, static_cast<float>(std::round(slow_rpm)), received)) ++errors;
    if (first) offset = counts - raw;
    if (encoder.totalCounts() + offset != counts || encoder.referenceLost()) ++errors;
  }
  return errors;
}

TEST(Encoder, CountsExactlyOverAnyMotionWithinTheModelsLimitsAndItsLostFrames) {
  for (const DjiModel* model : djiModels()) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      EXPECT_EQ(countErrors(model->encoder, model->countable_lost_frames, 500'000, seed), 0) << model->name;
    }
  }
}

/// Samples of a shaft at a steady or random speed, stamped late by up to so much: whether a count was ever
/// wrong without being noticed, and how often the reference was lost.
struct LateStamps {
  bool silently_wrong = false;
  std::uint64_t losses = 0;
  std::uint64_t jumps = 0;
};
LateStamps countLate(const Encoder::Config& config, double most_late_s, double steady, std::uint64_t seed,
                     double clock = 1.0) {
  RandomShaft shaft(config, seed);
  Encoder encoder(config);
  LateStamps result;
  MonotonicTime received{};
  double turns = 0.0;
  std::int64_t offset = 0;
  for (int sample = 0; sample < 100'000; ++sample) {
    shaft.advance(kPeriod_s * clock);
    const double rpm = steady != 0.0 ? steady * static_cast<double>(config.max_velocity_rpm) : shaft.rpm();
    turns = steady != 0.0 ? turns + rpm / 60.0 * kPeriod_s * clock : shaft.turns();
    const double late_s = shaft.uniform() * most_late_s;
    const auto stamp_ns = static_cast<std::int64_t>((1.0 + sample * kPeriod_s * clock + late_s) * 1e9);
    received = std::max(received, MonotonicTime{Duration{stamp_ns}});
    const auto counts = static_cast<std::int64_t>(std::floor(turns * config.counts_per_turn));
    const auto raw = static_cast<std::int32_t>(((counts % 8192) + 8192) % 8192);
    EXPECT_TRUE(encoder.update(raw, static_cast<float>(std::round(rpm)), received));
    if (sample == 0) offset = counts - raw;
    const bool right = encoder.totalCounts() + offset == counts;
    if (!right && !encoder.referenceLost()) result.silently_wrong = true;
    if (encoder.referenceLost()) {
      encoder.acknowledgeLoss();
      offset = counts - encoder.totalCounts();
    }
  }
  result.losses = encoder.losses();
  result.jumps = encoder.jumps();
  return result;
}

TEST(Encoder, StampsThatAreTwoMillisecondsLateCostNoTurn) {
  for (const DjiModel* model : djiModels()) {
    for (const double steady : {1.0, -0.95, 0.9, 0.8, 0.5, 0.25, 0.0}) {
      const auto late = countLate(model->encoder, 0.0019, steady, 3);
      EXPECT_FALSE(late.silently_wrong) << model->name << ' ' << steady;
      EXPECT_EQ(late.losses, 0U) << model->name << ' ' << steady;
      EXPECT_EQ(late.jumps, 0U) << model->name << ' ' << steady;
    }
  }
}

TEST(Encoder, AMiscountByStampsThatAreFourMillisecondsLateIsNoticed) {
  for (const double steady : {1.0, 0.9, 0.5, 0.0}) {
    EXPECT_FALSE(countLate(kM3508.encoder, 0.004, steady, 3).silently_wrong) << steady;
    EXPECT_FALSE(countLate(kGM6020.encoder, 0.004, steady, 3).silently_wrong) << steady;
  }
  EXPECT_GT(countLate(kM3508.encoder, 0.004, 1.0, 3).losses, 1000U) << "nothing here is exact by luck";
  EXPECT_FALSE(countLate(kM2006.encoder, 0.003, 0.9, 3).silently_wrong);
}

TEST(Encoder, ADriveWhoseClockIsOnePercentOffIsCountedExactly) {
  for (const DjiModel* model : djiModels()) {
    for (const double clock : {0.99, 1.01}) {
      const auto late = countLate(model->encoder, 0.0008, 0.9, 3, clock);
      EXPECT_FALSE(late.silently_wrong) << model->name << ' ' << clock;
      EXPECT_EQ(late.losses, 0U) << model->name << ' ' << clock;
    }
  }
}

TEST(Encoder, TheWayOfTwoPeriodsIsCountedOnceMoreThanATwentiethBeyondOneHasPassed) {
  const auto config = kM2006.encoder;
  const double turns_in_a_period = static_cast<double>(config.max_velocity_rpm) / 60.0 * kPeriod_s;
  const auto lostAfter = [&](Duration gap) {
    Encoder encoder(config);
    MonotonicTime now{milliseconds{1000}};
    double turns = 0.0;
    const auto sample = [&](double periods, Duration after) {
      turns += periods * turns_in_a_period;
      const auto raw = static_cast<std::int32_t>((turns - std::floor(turns)) * 8192.0) % 8192;
      EXPECT_TRUE(encoder.update(raw, config.max_velocity_rpm, now += after));
    };
    for (int i = 0; i < 10; ++i) sample(1.0, milliseconds{1});
    EXPECT_FALSE(encoder.referenceLost());
    sample(2.0, gap);
    return encoder.referenceLost();
  };
  EXPECT_TRUE(lostAfter(microseconds{1040})) << "no shaft turns so far in one period";
  EXPECT_FALSE(lostAfter(microseconds{1060})) << "one was lost, and the stamp is early";
}

TEST(Encoder, EveryModelSurvivesTheLostFramesOfItsTable) {
  for (const DjiModel* model : djiModels()) {
    const Encoder encoder(model->encoder);
    EXPECT_GE(encoder.longestGap() + model->encoder.stamp_error,
              milliseconds{model->countable_lost_frames + 1})
        << model->name;
    EXPECT_FALSE(Encoder::exactOver(model->encoder, model->countable_lost_frames + 2, milliseconds{1}))
        << model->name << ": the table is more modest than it need be";
  }
}

/// From -speed to speed and the like: the path that is farthest from the mean of its two ends.
double worstPathTurns(const Encoder::Config& config, double spacing_s, double start_rpm) {
  const double a = static_cast<double>(config.max_acceleration_rpm_per_s) / 60.0;
  return start_rpm / 60.0 * spacing_s + a * spacing_s * spacing_s / 4.0;
}

TEST(Encoder, TheWorstPathAtTheLongestGapIsStillCounted) {
  for (const DjiModel* model : djiModels()) {
    const Encoder::Config& config = model->encoder;
    const int frames = model->countable_lost_frames + 1;
    for (const double direction : {-1.0, 1.0}) {
      for (const Duration late : {-config.stamp_error, config.stamp_error}) {
        const double velocity_rpm = 0.8 * static_cast<double>(config.max_velocity_rpm);
        const double turns = direction * worstPathTurns(config, frames * kPeriod_s, velocity_rpm);
        const double reported = direction * (velocity_rpm - static_cast<double>(config.velocity_error_rpm));
        Encoder encoder(config);
        const MonotonicTime start{milliseconds{1000}};
        ASSERT_TRUE(encoder.update(0, static_cast<float>(reported), start));
        const auto counts = std::llround(turns * 8192.0);
        const auto raw = static_cast<std::int32_t>(((counts % 8192) + 8192) % 8192);
        const Duration gap = frames * Duration{milliseconds{1}} + late;
        ASSERT_TRUE(encoder.update(raw, static_cast<float>(reported), start + gap));
        EXPECT_EQ(encoder.totalCounts(), counts) << model->name;
        EXPECT_FALSE(encoder.referenceLost());
      }
    }
  }
}

TEST(Encoder, FullAccelerationAcrossTheLongestGapIsStillCounted) {
  for (const DjiModel* model : djiModels()) {
    const Encoder::Config& config = model->encoder;
    const int frames = model->countable_lost_frames + 1;
    const double end_rpm = 0.95 * static_cast<double>(config.max_velocity_rpm);
    const double gained_rpm = static_cast<double>(config.max_acceleration_rpm_per_s) * frames * kPeriod_s;
    const double start_rpm = std::max(end_rpm - gained_rpm, -end_rpm);
    const auto counts = std::llround((start_rpm + end_rpm) / 2.0 / 60.0 * frames * kPeriod_s * 8192.0);
    const auto raw = static_cast<std::int32_t>(((counts % 8192) + 8192) % 8192);
    for (const float wrong : {-config.velocity_error_rpm, config.velocity_error_rpm}) {
      for (const Duration late : {-config.stamp_error, config.stamp_error}) {
        Encoder encoder(config);
        const MonotonicTime start{milliseconds{1000}};
        ASSERT_TRUE(encoder.update(0, static_cast<float>(start_rpm) + wrong, start));
        ASSERT_TRUE(encoder.update(raw, static_cast<float>(end_rpm) + wrong,
                                   start + frames * milliseconds{1} + late));
        EXPECT_EQ(encoder.totalCounts(), counts) << model->name;
      }
    }
  }
}

TEST(Encoder, ALongerGapLosesTheReferenceUntilItIsAcknowledged) {
  Encoder encoder(kM2006.encoder);
  Encoder in_time(kM2006.encoder);
  const MonotonicTime start{milliseconds{1000}};
  ASSERT_TRUE(encoder.update(4000, 18000.0F, start));
  ASSERT_TRUE(encoder.update(4100, 18000.0F, start + encoder.longestGap() + Duration{1}));
  EXPECT_TRUE(encoder.referenceLost());
  ASSERT_TRUE(in_time.update(4000, 0.0F, start));
  ASSERT_TRUE(in_time.update(4000, 0.0F, start + in_time.longestGap()));
  EXPECT_FALSE(in_time.referenceLost());
  EXPECT_EQ(encoder.totalCounts(), 4100);  // the nearest: the position within the turn stays right
  ASSERT_TRUE(encoder.update(4200, 0.0F, start + encoder.longestGap() + milliseconds{1}));
  EXPECT_TRUE(encoder.referenceLost());
  encoder.acknowledgeLoss();
  EXPECT_FALSE(encoder.referenceLost());
}

TEST(Encoder, TurnsThatTwoSpacingsCountDifferentlyAreInDoubt) {
  for (const int stamped_ms : {1, 2}) {
    // 0.15 turns in a period: 0.52 are 0.13 less than one period explains, and 0.78 less than two.
    Encoder::Config config;
    config.velocity_error_rpm = 9000.0F;
    config.sample_period = milliseconds{1};
    Encoder encoder(config);
    const MonotonicTime first{milliseconds{1000}};
    ASSERT_TRUE(encoder.update(0, 39'000.0F, first));
    ASSERT_TRUE(encoder.update(4260, 39'000.0F, first + milliseconds{stamped_ms}));
    EXPECT_EQ(encoder.referenceLost(), stamped_ms == 2) << stamped_ms;
    EXPECT_EQ(encoder.jumps(), 0U);
  }
}

TEST(Encoder, CountsBothDirectionsAcrossTheWrap) {
  Encoder encoder(kM3508.encoder);
  MonotonicTime now{milliseconds{1}};
  ASSERT_TRUE(encoder.update(8190, 0.0F, now));
  ASSERT_TRUE(encoder.update(2, 30.0F, now += milliseconds{1}));
  EXPECT_EQ(encoder.totalCounts(), 8194);
  ASSERT_TRUE(encoder.update(8000, -300.0F, now += milliseconds{1}));
  EXPECT_EQ(encoder.totalCounts(), 8000);
}

TEST(Encoder, EqualOrSwappedStampsCountAsNoTime) {
  Encoder encoder(kM3508.encoder);
  const MonotonicTime now{milliseconds{50}};
  ASSERT_TRUE(encoder.update(0, 9000.0F, now));
  ASSERT_TRUE(encoder.update(1229, 9000.0F, now));
  ASSERT_TRUE(encoder.update(2458, 9000.0F, now - milliseconds{3}));
  EXPECT_EQ(encoder.totalCounts(), 2458);
}

TEST(Encoder, RefusesWhatIsOutOfRangeAndChangesNothing) {
  Encoder encoder(kM3508.encoder);
  const MonotonicTime now{milliseconds{50}};
  EXPECT_FALSE(encoder.update(8192, 0.0F, now));
  EXPECT_FALSE(encoder.update(-1, 0.0F, now));
  EXPECT_FALSE(encoder.hasSample());
  ASSERT_TRUE(encoder.update(17, 0.0F, now));
  EXPECT_FALSE(encoder.update(9000, 0.0F, now + milliseconds{1}));
  EXPECT_FALSE(encoder.update(18, std::numeric_limits<float>::quiet_NaN(), now + milliseconds{1}));
  EXPECT_EQ(encoder.totalCounts(), 17);
}

TEST(Encoder, ABillionTurnsLoseNotOneCount) {
  // A perfect shaft, so that one sample may be a minute apart: 10^6 rpm are 10^6 turns per sample.
  const Encoder::Config perfect{.counts_per_turn = 8192, .max_velocity_rpm = 1e6F};
  for (const float direction : {1.0F, -1.0F}) {
    Encoder encoder(perfect);
    MonotonicTime now{};
    ASSERT_TRUE(encoder.update(123, direction * 1e6F, now));
    for (int i = 0; i < 1000; ++i) {
      ASSERT_TRUE(encoder.update(123, direction * 1e6F, now += std::chrono::minutes{1}));
    }
    EXPECT_FALSE(encoder.referenceLost());
    EXPECT_EQ(encoder.totalCounts(), 123 + (direction > 0 ? 1 : -1) * 1'000'000'000LL * 8192);
  }
}

TEST(Encoder, ASpeedBeyondAllReasonDoesNotOverflow) {
  Encoder encoder({.counts_per_turn = 8192, .max_velocity_rpm = 1e6F});
  ASSERT_TRUE(encoder.update(0, 3e38F, MonotonicTime{}));
  EXPECT_TRUE(encoder.update(5, 3e38F, MonotonicTime{std::chrono::minutes{30}}));
}

TEST(Encoder, AShaftTooFastForTheStampErrorCanNeverBeCounted) {
  for (const float rpm_per_s : {0.0F, 1e5F}) {
    const Encoder encoder({.max_velocity_rpm = 60'000.0F,
                           .max_acceleration_rpm_per_s = rpm_per_s,
                           .stamp_error = microseconds{1000}});
    EXPECT_EQ(encoder.longestGap(), Duration{0});
  }
}

TEST(Encoder, TheLongestGapIsWhereThePredictionIsHalfATurnOff) {
  for (const Encoder::Config& config :
       {Encoder::Config{.max_velocity_rpm = 9000.0F, .max_acceleration_rpm_per_s = 1e5F},
        Encoder::Config{.max_velocity_rpm = 9000.0F, .velocity_error_rpm = 200.0F},
        Encoder::Config{.max_velocity_rpm = 3000.0F,
        .max_acceleration_rpm_per_s = 2e5F,
        .velocity_error_rpm = 100.0F,
        .stamp_error = microseconds{300}},
        Encoder::Config{.velocity_error_rpm = 0.01F}}) {
    const Encoder encoder(config);
    EXPECT_NEAR(Encoder::predictionErrorTurns(config, encoder.longestGap() + config.stamp_error), 0.4997,
                1e-6);
  }
}

TEST(Encoder, WithoutAnythingThatBoundsItAGapIsAnHour) {
  EXPECT_EQ(Encoder(Encoder::Config{}).longestGap(), std::chrono::hours{1});
  EXPECT_EQ(Encoder(Encoder::Config{.velocity_error_rpm = 0.005F}).longestGap(), std::chrono::hours{1});
}

TEST(Encoder, TheDelayOfAStampIsKnownUntilOneComesInTime) {
  Encoder encoder(kM3508.encoder);
  MonotonicTime now{milliseconds{1000}};
  std::int32_t raw = 0;
  // A tenth of a turn in a period.
  const auto sample = [&](Duration after) {
    raw = (raw + 819) % 8192;
    EXPECT_TRUE(encoder.update(raw, 6000.0F, now += after));
    return encoder.stampDelay();
  };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(sample(milliseconds{1}), Duration{0});
  EXPECT_EQ(sample(microseconds{1500}), microseconds{500 - 15}) << "a hundredth of the gap is forgotten";
  EXPECT_EQ(sample(microseconds{1000}), microseconds{500 - 15 - 10});
  EXPECT_EQ(sample(microseconds{500}), Duration{0});
  EXPECT_EQ(sample(microseconds{1500}), microseconds{485});
  EXPECT_TRUE(encoder.update(raw, 0.0F, now += std::chrono::hours{2}));
  EXPECT_EQ(encoder.stampDelay(), Duration{0}) << "after a gap nothing is known of it";
}

TEST(Encoder, AJumpAtRestIsNoticedAndLosesTheReference) {
  Encoder encoder(kM3508.encoder);
  MonotonicTime now{};
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(encoder.update(1000, 0.0F, now += milliseconds{1}));
  EXPECT_EQ(encoder.jumps(), 0U);
  EXPECT_TRUE(encoder.update(1000 + 8192 * 3 / 10, 0.0F, now += milliseconds{1}));
  EXPECT_EQ(encoder.jumps(), 1U);
  EXPECT_EQ(encoder.losses(), 1U);
  EXPECT_TRUE(encoder.referenceLost());
}

TEST(Encoder, NoMotionThatTheShaftCanMakeIsAJump) {
  for (const auto* model : djiModels()) {
    RandomShaft shaft(model->encoder, 7);
    Encoder encoder(model->encoder);
    MonotonicTime now{};
    for (int i = 0; i < 200'000; ++i) {
      shaft.advance(kPeriod_s);
      now += milliseconds{1};
      const double fraction = shaft.turns() - std::floor(shaft.turns());
      const auto raw = static_cast<std::int32_t>(fraction * 8192) % 8192;
      ASSERT_TRUE(encoder.update(raw, static_cast<float>(shaft.rpm()), now));
    }
    EXPECT_EQ(encoder.jumps(), 0U) << model->name;
  }
}

TEST(Encoder, SamplesThatWereReadLateAndTogetherAreNoJump) {
  // A paused receiver: twelve samples of a turning motor at once, then the next one in time.
  for (const float rpm : {50.0F, 500.0F, 2000.0F, 9000.0F}) {
    Encoder encoder(kM3508.encoder);
    MonotonicTime now{};
    double turns = 0.0;
    for (int i = 0; i < 2000; ++i) {
      turns += static_cast<double>(rpm) / 60.0 * kPeriod_s;
      const int late = i % 12;
      const auto stamp = MonotonicTime{} + milliseconds{i + 12 - late};
      now = std::max(now, stamp);
      const auto raw = static_cast<std::int32_t>((turns - std::floor(turns)) * 8192) % 8192;
      ASSERT_TRUE(encoder.update(raw, rpm, now));
    }
    EXPECT_EQ(encoder.jumps(), 0U) << rpm;
  }
}

}  // namespace
}  // namespace rc10::test::encoder_test
