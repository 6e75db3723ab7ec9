#include "module/power_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// Rate of the factor for each part of the limit that is missing or left: down within 50 ms at twice
// the limit, up more slowly, so that it does not hunt.
constexpr double kDownPerS = 20.0;
constexpr double kUpPerS = 2.0;
// Rate of the factor towards the power's forecast: motors follow what they are told in a few milliseconds.
constexpr double kPredictSeconds = 0.005;
// Horizon of the forecast of the power, from its growth.
constexpr double kAheadSeconds = 0.01;

}  // namespace

double PowerLimiter::step(double power_w, const Shares& shares, float dt_s) noexcept {
  if (limit_w_ <= 0.0 || !std::isfinite(power_w) || !(dt_s > 0.0F)) return factor_;
  const double left = std::clamp(1.0 - power_w / limit_w_, -1.0, 1.0);
  const auto dt = static_cast<double>(dt_s);
  growth_w_per_s_ += ((power_w - power_w_) / dt - growth_w_per_s_) * dt / (kPredictSeconds + dt);
  power_w_ = power_w;
  const double ahead = shares.told - shares.measured;
  // An accelerating motor takes power in proportion to its lag behind the command: the lead is scaled down. A
  // factor far above the motion would come down too late.
  const double soon_w = power_w + std::max(0.0, growth_w_per_s_) * kAheadSeconds;
  if (soon_w > limit_w_ && ahead > 0.0 && std::isfinite(ahead)) {
    const double fits = shares.measured + ahead * limit_w_ / soon_w;
    if (fits < factor_) factor_ += (fits - factor_) * dt / (kPredictSeconds + dt);
  }
  factor_ += (left < 0.0 ? kDownPerS : kUpPerS) * left * static_cast<double>(dt_s);
  factor_ = std::clamp(factor_, kLeast, 1.0);
  return factor_;
}

}  // namespace rc10
