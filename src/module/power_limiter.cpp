#include "module/power_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// How fast the factor changes for each part of the limit that is missing or left: down within 50 ms at twice
// the limit, up more slowly, so that it does not hunt.
constexpr double kDownPerS = 20.0;
constexpr double kUpPerS = 2.0;

}  // namespace

double PowerLimiter::step(double power_w, float dt_s) noexcept {
  if (limit_w_ <= 0.0 || !std::isfinite(power_w) || !(dt_s > 0.0F)) return factor_;
  const double left = std::clamp(1.0 - power_w / limit_w_, -1.0, 1.0);
  factor_ += (left < 0.0 ? kDownPerS : kUpPerS) * left * static_cast<double>(dt_s);
  factor_ = std::clamp(factor_, kLeast, 1.0);
  return factor_;
}

}  // namespace rc10
