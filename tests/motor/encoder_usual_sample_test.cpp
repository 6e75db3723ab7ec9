// update() counts usual samples by a short cut: each must leave what updateByAllSpacings() leaves.
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "drives/dji/dji_model.hpp"
#include "motor/encoder.hpp"

namespace rc10::test::encoder_usual_sample_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Duration kPeriod = milliseconds{1};

/// Samples at random, of which most are near an edge of the short cut.
class RandomSamples {
 public:
  RandomSamples(const Encoder::Config& config, std::uint64_t seed) : config_(config), random_(seed) {}

  void next() {
    const float before_rpm = velocity_rpm;
    velocity_rpm = nextVelocity();
    const Duration gap = nextGap();
    const double mean_rpm = (static_cast<double>(before_rpm) + static_cast<double>(velocity_rpm)) / 2.0;
    const double turns = mean_rpm / 60.0 * static_cast<double>(seconds(nextSpacing(gap)));
    const auto counts = std::isfinite(turns) ? std::llround(std::fmod(turns, 1.0) * 8192.0) : 0;
    raw_counts = static_cast<std::int32_t>(((raw_counts + counts + nextNoise()) % 8192 + 8192) % 8192);
    received += gap;
  }
  [[nodiscard]] bool oneOf(std::uint64_t n) { return random_() % n == 0; }

  std::int32_t raw_counts = 4000;
  float velocity_rpm = 0.0F;
  MonotonicTime received{milliseconds{1000}};

 private:
  template <typename T, std::size_t N>
  [[nodiscard]] T anyOf(const std::array<T, N>& choices) {
    return choices[random_() % N];
  }
  [[nodiscard]] Duration below(Duration most) {
    return Duration{static_cast<Duration::rep>(random_() % static_cast<std::uint64_t>(most.count()))};
  }
  // Steady for a while, or another share of the most; rarely none that a drive reports.
  [[nodiscard]] float nextVelocity() {
    if (oneOf(1000)) return std::numeric_limits<float>::quiet_NaN();
    if (!std::isfinite(velocity_rpm)) return 0.0F;
    if (oneOf(1000)) return anyOf<float>(std::array{3e38F, -3e38F, std::numeric_limits<float>::infinity()});
    if (!oneOf(8)) return velocity_rpm;
    return config_.max_velocity_rpm *
           anyOf(std::array{0.0F, 1e-4F, -0.01F, 0.05F, -0.05F, 0.3F, -0.3F, 1.0F, -1.0F, 1.1F, 3.0F});
  }
  [[nodiscard]] Duration nextGap() {
    if (oneOf(4)) return kPeriod;
    if (oneOf(4)) return below(2 * kPeriod);
    if (oneOf(8)) return below(12 * kPeriod);
    const Duration around = microseconds{static_cast<int>(random_() % 5) - 2};
    return anyOf(std::array{Duration{0}, Duration{-1000}, kPeriod, kPeriod + around, kPeriod + 50 * around,
                            2 * kPeriod - kPeriod / 20, 2 * kPeriod - kPeriod / 20 - Duration{1},
                            kPeriod + kPeriod / 20, kPeriod + kPeriod / 20 - Duration{1}, 2 * kPeriod,
                            3 * kPeriod});
  }
  // The time for which the shaft has turned in truth.
  [[nodiscard]] Duration nextSpacing(Duration gap) {
    return oneOf(4) ? anyOf(std::array{Duration{0}, gap, 2 * kPeriod}) : kPeriod;
  }
  // The short cut ends at 0.02 turns, 163.84 counts, beside the prediction, and at half a turn.
  [[nodiscard]] std::int32_t nextNoise() {
    if (!oneOf(3)) return static_cast<std::int32_t>(random_() % 5) - 2;
    const std::int32_t way =
        anyOf<std::int32_t>(std::array{20, 81, 82, 163, 164, 400, 2048, 4095, 4096, 4097});
    return oneOf(2) ? way : -way;
  }

  Encoder::Config config_;
  std::mt19937_64 random_;
};

void expectTheSame(const Encoder::Config& config, std::uint64_t seed) {
  RandomSamples samples(config, seed);
  Encoder encoder(config);
  Encoder reference(config);
  for (int i = 0; i < 300'000; ++i) {
    samples.next();
    const auto raw = samples.oneOf(500) ? samples.raw_counts + 8192 : samples.raw_counts;
    const bool taken = encoder.update(raw, samples.velocity_rpm, samples.received);
    ASSERT_EQ(taken, reference.updateByAllSpacings(raw, samples.velocity_rpm, samples.received)) << i;
    ASSERT_EQ(encoder.totalCounts(), reference.totalCounts()) << i;
    ASSERT_EQ(encoder.stampDelay(), reference.stampDelay()) << i;
    ASSERT_EQ(encoder.referenceLost(), reference.referenceLost()) << i;
    ASSERT_EQ(encoder.losses(), reference.losses()) << i;
    ASSERT_EQ(encoder.jumps(), reference.jumps()) << i;
    if (!encoder.referenceLost() || samples.oneOf(2)) continue;
    encoder.acknowledgeLoss();
    reference.acknowledgeLoss();
  }
}

TEST(EncoderUsualSample, LeavesOfEachModelWhatAllSpacingsLeave) {
  for (const DjiModel* model : djiModels()) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      SCOPED_TRACE(testing::Message() << model->name << ", seed " << seed);
      expectTheSame(model->encoder, seed);
    }
  }
}

TEST(EncoderUsualSample, LeavesWhatAllSpacingsLeaveWithoutAPeriodAndWithoutAnyError) {
  Encoder::Config config = kM3508.encoder;
  config.sample_period = Duration{0};
  expectTheSame(config, 1);
  expectTheSame({.counts_per_turn = 8192, .max_velocity_rpm = 10'000.0F, .sample_period = kPeriod}, 1);
}

TEST(EncoderUsualSample, LeavesWhatAllSpacingsLeaveWhereThePeriodIsLongerThanAnyGapThatIsCounted) {
  Encoder::Config config = kM3508.encoder;
  config.max_acceleration_rpm_per_s = 1e8F;
  ASSERT_LT(Encoder(config).longestGap(), kPeriod);
  expectTheSame(config, 1);
}

}  // namespace
}  // namespace rc10::test::encoder_usual_sample_test
