#include "motor/lead_bound.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace rc10 {
namespace {

// Time in which a shaft that lags, and so may have more to carry, gets the whole torque.
constexpr double kWholeS = 1.0;
// Share of the limit below which it lags.
constexpr double kLags = 0.1;
// Share of the limit above which it was let go, and the time in which the whole torque is taken back then.
constexpr double kLetGo = 1.5;
constexpr double kLetGoS = 0.02;
constexpr Duration kLongestStep = std::chrono::milliseconds{10};

}  // namespace

bool LeadBound::apply(SpringLaw& law, const SpringState& at, double limit_rad_s, double most_nm,
                      MonotonicTime now) noexcept {
  if (!(law.damping_nms_per_rad > 0.0)) return false;
  const double step_s =
      std::chrono::duration<double>(std::min<Duration>(now - last_.value_or(now), kLongestStep)).count();
  last_ = now;
  const double wanted_rad = law.position_rad;
  const double carried_rad_s = load_nm_ / law.damping_nms_per_rad;
  if (!boundLead(law, at, carried_rad_s - limit_rad_s - law.velocity_rad_s,
                 carried_rad_s + limit_rad_s - law.velocity_rad_s))
    return false;
  const double sign = wanted_rad > law.position_rad ? 1.0 : -1.0;
  const double towards_rad_s = sign * at.velocity_rad_s;
  // Drawn away, it meets the spring's own stiffness; and the place that leads it on goes no faster than the
  // limit.
  if (towards_rad_s < 0.0)
    load_nm_ -= law.stiffness_nm_per_rad * at.velocity_rad_s * step_s;
  else if (towards_rad_s > limit_rad_s)
    load_nm_ -= sign * law.stiffness_nm_per_rad * (towards_rad_s - limit_rad_s) * step_s;
  // Let go by what held it back, it carries nothing any more.
  if (towards_rad_s > kLetGo * limit_rad_s && sign * load_nm_ > 0.0)
    load_nm_ = sign * std::max(sign * load_nm_ - most_nm * step_s / kLetGoS, 0.0);
  if (towards_rad_s < kLags * limit_rad_s) load_nm_ += sign * most_nm * step_s / kWholeS;
  load_nm_ = std::clamp(load_nm_, -most_nm, most_nm);
  return true;
}

}  // namespace rc10
