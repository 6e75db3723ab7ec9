#include "app/motion_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rc10 {
namespace {

constexpr double kLongestLagSeconds = 0.040;
// Changes are taken over about this time: long against the steps of a speed that is told in whole rpm, short
// against the motion of a vehicle.
constexpr double kChangeSeconds = 0.025;
constexpr double kMemorySeconds = 0.5;
// A value that is told again is a new one after this time: a shaft may stand still.
constexpr double kRepeatSeconds = 0.025;
// Share of the motor's energy. A vehicle that carries the shaft leaves 1, an exact match noise.
constexpr double kTight = 0.2;
// The same, of the worst candidate less the best: at an even acceleration each lag fits as well.
constexpr double kDistinct = 0.2;
constexpr int kFewest = 4;
// Nobody takes a sensor off and mounts it anew in less.
constexpr double kRemountSeconds = 2.0;

}  // namespace

std::optional<double> MotionMatch::lagSeconds() const noexcept {
  if (!lag_) return std::nullopt;
  return static_cast<double>(*lag_) * period_s_;
}

double MotionMatch::motorThen() const noexcept {
  const std::size_t lag = lag_.value_or(0);
  return lag < count_ ? ago(lag).motor : std::numeric_limits<double>::quiet_NaN();
}

void MotionMatch::reset() noexcept {
  candidates_.fill({});
  count_ = 0;  // no change is counted from before it
  learned_ = 0;
  sign_ = Sign::kUnknown;
  lag_.reset();
}

double MotionMatch::change(double from, double to) const noexcept {
  return config_.circular_period > 0.0 ? std::remainder(to - from, config_.circular_period) : to - from;
}

std::size_t MotionMatch::ticksOf(double duration_s, std::size_t most) const noexcept {
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(std::min(duration_s / period_s_, 1e3))),
                                 1, most);
}

void MotionMatch::step(double motor, double sensor, float dt_s) noexcept {
  fresh_ = false;
  const auto dt = static_cast<double>(dt_s);
  if (!std::isfinite(motor) || !std::isfinite(sensor) || !(dt > 0.0)) {
    count_ = 0;
    gap_s_ += std::isfinite(dt) ? dt : 0.0;
    if (gap_s_ >= kRemountSeconds && sign_ == Sign::kAgrees) reset();
    return;
  }
  gap_s_ = 0.0;
  if (period_s_ == 0.0 || dt < 0.5 * period_s_) period_s_ = dt;
  if (dt > 1.5 * period_s_) count_ = 0;  // ticks are missing: ages are not counted over them
  since_fresh_s_ += dt;
  fresh_ = count_ == 0 || sensor != ago(0).sensor || since_fresh_s_ >= kRepeatSeconds;
  newest_ = (newest_ + 1) % kRoom;
  ticks_[newest_] = {motor, sensor, fresh_};
  count_ = std::min(count_ + 1, kRoom);
  if (!fresh_) return;
  learn(std::min(since_fresh_s_, kRepeatSeconds));
  since_fresh_s_ = 0.0;
}

// The sensor's change since its value of a while ago, against the motor's over the same time, for each lag.
void MotionMatch::learn(double elapsed_s) noexcept {
  const std::size_t lags = ticksOf(kLongestLagSeconds, kLags - 1) + 1;
  std::size_t back = ticksOf(kChangeSeconds, kRoom / 2);
  if (count_ < back + lags) return;
  while (back > 0 && !ago(back).fresh) --back;
  if (back == 0) return;
  const double keep = std::exp(-elapsed_s / kMemorySeconds);
  const double sensor = change(ago(back).sensor, ago(0).sensor);
  for (std::size_t lag = 0; lag < lags; ++lag) {
    const double motor = change(ago(lag + back).motor, ago(lag).motor);
    auto& sums = candidates_[lag];
    sums.energy = sums.energy * keep + motor * motor * elapsed_s;
    sums.same = sums.same * keep + (sensor - motor) * (sensor - motor) * elapsed_s;
    sums.opposite = sums.opposite * keep + (sensor + motor) * (sensor + motor) * elapsed_s;
  }
  learned_ = std::min(learned_ + 1, kFewest);
  if (learned_ == kFewest) judge(lags);
}

void MotionMatch::judge(std::size_t candidates) noexcept {
  const auto first = candidates_.begin();
  const auto last = first + static_cast<std::ptrdiff_t>(candidates);
  const auto matches = [&](const Candidate& best, double residual) {
    return best.energy >= config_.enough && residual <= kTight * best.energy;
  };
  const auto [same, worst] = std::minmax_element(
      first, last, [](const Candidate& a, const Candidate& b) { return a.same < b.same; });
  if (matches(*same, same->same)) {
    if (sign_ == Sign::kUnknown) sign_ = Sign::kAgrees;
    if (worst->same - same->same >= kDistinct * same->energy) lag_ = static_cast<std::size_t>(same - first);
    return;
  }
  const auto opposite = std::min_element(
      first, last, [](const Candidate& a, const Candidate& b) { return a.opposite < b.opposite; });
  if (sign_ == Sign::kUnknown && matches(*opposite, opposite->opposite)) sign_ = Sign::kOpposed;
}

}  // namespace rc10
