#include "motor/encoder.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

/// The largest spacing, in truth, for which the prediction error stays under `bound` turns.
double longestSpacingSeconds(const Encoder::Config& config, double bound) noexcept {
  const double left = bound - Encoder::predictionErrorTurns(config, Duration{0});
  if (left <= 0.0) return 0.0;
  const double a = static_cast<double>(config.max_acceleration_rpm_per_s) / kRpmPerTurnPerS / 4.0;
  const double b = static_cast<double>(config.velocity_error_rpm) / kRpmPerTurnPerS;
  // a t^2 + b t = left, in the form that also holds for a = 0; an hour if nothing bounds it.
  const double denominator = b + std::sqrt(b * b + 4.0 * a * left);
  constexpr double kHour = 3600.0;
  return denominator > 2.0 * left / kHour ? 2.0 * left / denominator : kHour;
}

// Beyond this a jump cannot be told from a wrap.
constexpr double kLargestNoticedTurns = 0.45;
// Margin for the encoder itself: quantisation and eccentricity.
constexpr double kJumpMarginTurns = 0.02;
constexpr Duration::rep kMostLatePeriods = 2;
constexpr double kMostTurns = 1e9;
constexpr double kTurnsPerNsPerRpm = 1.0 / (kRpmPerTurnPerS * 1e9);

double nanoseconds(Duration spacing) noexcept { return static_cast<double>(spacing.count()); }

// Mean speed between two samples.
double turnsPerNs(double before_rpm, double now_rpm) noexcept {
  return (before_rpm + now_rpm) * (0.5 * kTurnsPerNsPerRpm);
}

}  // namespace

Encoder::Encoder(const Config& config) noexcept
    : config_(config),
      turns_per_count_(1.0 / static_cast<double>(config.counts_per_turn)),
      error_per_ns2_(static_cast<double>(config.max_acceleration_rpm_per_s) * kTurnsPerNsPerRpm * 1e-9 / 4.0),
      error_per_ns_(static_cast<double>(config.velocity_error_rpm) * kTurnsPerNsPerRpm),
      period_ns_(nanoseconds(config.sample_period)),
      rounding_(config.sample_period - config.sample_period / 20) {
  const double spacing_s = longestSpacingSeconds(config, kHalfTurn);
  // The stamps may make the spacing look shorter than it is.
  longest_gap_ =
      std::max(Duration{0}, std::chrono::duration_cast<Duration>(std::chrono::duration<double>(spacing_s)) -
                                config.stamp_error);
  const Duration one_period = 2 * config.sample_period - rounding_ - Duration{1};
  longest_usual_ = config.sample_period > Duration{0} ? std::min(one_period, longest_gap_) : Duration{-1};
}

void Encoder::loseReference() noexcept {
  reference_lost_ = true;
  ++losses_;
}

// Stamps may be late by as much as a gap that is still counted over: a paused receiver reads many samples
// at once. Up to there speed explains the difference.
bool Encoder::jumped(double off_turns, float velocity_rpm, Duration gap) const noexcept {
  const double fastest_rpm = std::max(std::fabs(static_cast<double>(velocity_rpm)), std::fabs(velocity_rpm_));
  Config moving = config_;
  moving.max_velocity_rpm = static_cast<float>(fastest_rpm);
  moving.stamp_error = longest_gap_;
  const double explained = predictionErrorTurns(moving, gap + 2 * config_.stamp_error) + kJumpMarginTurns;
  return explained < kLargestNoticedTurns && off_turns > explained;
}

inline Encoder::Step Encoder::stepOver(double moved_turns, double turns_per_ns,
                                       double spacing_ns) const noexcept {
  const double ahead = turns_per_ns * spacing_ns - moved_turns;
  const double way = std::fabs(ahead);
  const double explained = errorTurns(spacing_ns) + kJumpMarginTurns;
  if (way < 0.5) return {.turns = 0, .explained = way <= explained, .off = way};  // nearly always
  // A speed beyond all reason must not overflow the conversion.
  if (!(way < kMostTurns)) return {.turns = 0, .explained = false, .off = way};
  const auto turns = static_cast<std::int32_t>(ahead + std::copysign(0.5, ahead));
  const double off = std::fabs(ahead - static_cast<double>(turns));
  return {.turns = turns, .explained = off <= explained, .off = off};
}

// By the stamps, and by whole periods from what they say down to two less: of these, the number of turns that
// speed and position agree on.
Encoder::Step Encoder::chooseStep(double moved_turns, double turns_per_ns, Duration gap) noexcept {
  Step chosen = stepOver(moved_turns, turns_per_ns, nanoseconds(gap));
  const Duration period = config_.sample_period;
  if (period <= Duration{0}) return chosen;
  const Duration arrived = gap + late_;
  const auto most = std::max<Duration::rep>(1, (arrived + rounding_) / period);
  const auto least = std::max<Duration::rep>(0, most - kMostLatePeriods);
  const Duration longest = most * period;
  Duration late = late_;
  bool differ = false;
  bool disagree = false;
  for (Duration spacing = least * period; spacing <= longest; spacing += period) {
    const Step other = stepOver(moved_turns, turns_per_ns, nanoseconds(spacing));
    const bool both_explained = other.explained && chosen.explained;
    if (other.turns != chosen.turns) {
      differ = true;
      disagree |= both_explained;
    }
    if (!other.explained || (both_explained && other.off > chosen.off)) continue;
    chosen = other;
    late = arrived - spacing;
  }
  chosen.in_doubt = chosen.explained ? disagree : differ;
  remember(late, gap);
  return chosen;
}

// Clocks drift: what is not seen again is forgotten.
inline void Encoder::remember(Duration late, Duration gap) noexcept {
  late_ = Duration{0};
  if (late <= Duration{0}) return;
  const Duration remembered = std::min(late - gap / 100, kMostLatePeriods * config_.sample_period);
  late_ = std::max(remembered, Duration{0});
}

// The choice of chooseStep() where one period has passed, so that its spacings are none, one, and what the
// stamps say, which is no more than a twentieth beyond one: no turn, where the movement is less than half of
// one and the prediction over a period within the margin of it. The best of the spacings is then explained,
// too, and tells the delay of the stamp.
inline bool Encoder::countUsual(std::int32_t raw_counts, float velocity_rpm,
                                MonotonicTime received) noexcept {
  const Duration gap = std::max(Duration{0}, received - received_);
  const Duration arrived = gap + late_;
  if (!has_sample_ || arrived > longest_usual_ || raw_counts < 0 || raw_counts >= config_.counts_per_turn)
    return false;
  const std::int32_t moved = raw_counts - raw_counts_;
  const double moved_turns = static_cast<double>(moved) * turns_per_count_;
  const double turns_per_ns = turnsPerNs(velocity_rpm_, static_cast<double>(velocity_rpm));
  const double off_at_once = std::fabs(moved_turns);
  const double off_by_stamps = std::fabs(turns_per_ns * nanoseconds(gap) - moved_turns);
  const double off_by_period = std::fabs(turns_per_ns * period_ns_ - moved_turns);
  // False for a speed that is not finite, too.
  if (!(off_by_period <= kJumpMarginTurns && off_at_once < 0.5)) return false;
  Duration late = off_at_once <= off_by_stamps ? arrived : late_;
  if (off_by_period <= off_by_stamps && off_by_period <= off_at_once) late = arrived - config_.sample_period;
  remember(late, gap);
  total_counts_ += moved;
  raw_counts_ = raw_counts;
  velocity_rpm_ = static_cast<double>(velocity_rpm);
  received_ = received;
  return true;
}

bool Encoder::update(std::int32_t raw_counts, float velocity_rpm, MonotonicTime received) noexcept {
  return countUsual(raw_counts, velocity_rpm, received) ||
         updateByAllSpacings(raw_counts, velocity_rpm, received);
}

bool Encoder::updateByAllSpacings(std::int32_t raw_counts, float velocity_rpm,
                                  MonotonicTime received) noexcept {
  if (raw_counts < 0 || raw_counts >= config_.counts_per_turn || !std::isfinite(velocity_rpm)) return false;
  if (!has_sample_) {
    has_sample_ = true;
    total_counts_ = raw_counts;
  } else {
    const Duration gap = std::max(Duration{0}, received - received_);  // stamps may swap, time does not
    const bool countable = gap <= longest_gap_;
    const double turns_per_ns = turnsPerNs(velocity_rpm_, static_cast<double>(velocity_rpm));
    const std::int32_t moved = raw_counts - raw_counts_;
    const double moved_turns = static_cast<double>(moved) * turns_per_count_;
    // Too far apart, the nearest wrap keeps the position within the turn right.
    const Step step =
        countable ? chooseStep(moved_turns, turns_per_ns, gap) : stepOver(moved_turns, 0.0, 0.0);
    total_counts_ += moved + std::int64_t{step.turns} * config_.counts_per_turn;
    if (!countable) late_ = Duration{0};
    const bool leapt = countable && !step.explained && jumped(step.off, velocity_rpm, gap);
    if (leapt) ++jumps_;
    if (!countable || step.in_doubt || leapt) loseReference();
  }
  raw_counts_ = raw_counts;
  velocity_rpm_ = static_cast<double>(velocity_rpm);
  received_ = received;
  return true;
}

}  // namespace rc10
