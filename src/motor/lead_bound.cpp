#include "motor/lead_bound.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace rc10 {
namespace {

// Time constant of the load, from the torque of the law. In the bound it is the integral of a speed loop
// whose proportional gain is the damping: longer than four times inertia over damping it does not overshoot.
constexpr double kBalanceS = 0.5;
// Time in which a shaft that lags, and so may have more to carry, gets the whole torque.
constexpr double kWholeS = 1.0;
// The same for one that does not follow a place beyond what holds it: a load sinks as soon as less is left.
constexpr double kUnwindS = 0.3;
// Shares of the limit: below the first it lags, below the second it stands, above the third it runs.
constexpr double kLags = 0.1;
constexpr double kStands = 0.5;
constexpr double kRuns = 1.5;
// A load at balance does not start to run: after so long it was let go. The spring of a load that has just
// sagged swings back with up to 0.16 of load over damping, whatever the inertia: what is faster was let go.
constexpr double kStoodS = 0.3;
constexpr double kSwing = 0.3;
// Time at more than half the limit after which it moves along: one that was let go is past the limit sooner.
constexpr double kMovesS = 0.1;
// Time in which the whole torque is taken back from a shaft that was let go.
constexpr double kLetGoS = 0.02;
// Share of the most from which on a load is taken for one that the motor does not move: a hand, a stop.
constexpr double kWoundUp = 0.98;
constexpr Duration kLongestStep = std::chrono::milliseconds{10};

// Torque of spring and damper, without the part that is fed forward.
double springNm(SpringLaw law, const SpringState& at) noexcept {
  law.torque_nm = 0.0;
  return torqueNm(law, at);
}

}  // namespace

bool LeadBound::woundUp(double most_nm) const noexcept { return std::fabs(load_nm_) >= kWoundUp * most_nm; }

void LeadBound::dropWindup(double velocity_rad_s, double limit_rad_s, double most_nm) noexcept {
  const bool pushes = asks_ * load_nm_ > 0.0;  // a load that is lowered does not
  if (pushes && woundUp(most_nm) && asks_ * velocity_rad_s < kStands * limit_rad_s) load_nm_ = carried_nm_;
}

bool LeadBound::apply(SpringLaw& law, const SpringState& at, double limit_rad_s, double most_nm,
                      MonotonicTime now) noexcept {
  const double damping = law.damping_nms_per_rad;
  if (!(damping > 0.0 && law.stiffness_nm_per_rad > 0.0)) return false;
  const double step_s =
      std::chrono::duration<double>(std::min<Duration>(now - last_.value_or(now), kLongestStep)).count();
  last_ = now;
  const double wanted_rad = law.position_rad;
  const auto bounded = [&](double load_nm) {
    SpringLaw led = law;
    const double carried_rad_s = load_nm / damping;
    (void)boundLead(led, at, carried_rad_s - limit_rad_s - law.velocity_rad_s,
                    carried_rad_s + limit_rad_s - law.velocity_rad_s);
    return led;
  };
  const auto side_of = [&](const SpringLaw& led) {
    return wanted_rad == led.position_rad ? 0.0 : std::copysign(1.0, wanted_rad - led.position_rad);
  };
  SpringLaw nearer = bounded(load_nm_);
  // The place is asked for on the other side of what holds the shaft: to press on would lead away from it.
  if (side_of(nearer) * load_nm_ < 0.0 && woundUp(most_nm) &&
      std::fabs(at.velocity_rad_s) < kStands * limit_rad_s) {
    load_nm_ = carried_nm_;
    nearer = bounded(load_nm_);
  }
  law = nearer;
  asks_ = side_of(law);
  estimate(law, at, limit_rad_s, most_nm, step_s);
  return asks_ != 0.0;
}

void LeadBound::estimate(const SpringLaw& law, const SpringState& at, double limit_rad_s, double most_nm,
                         double step_s) noexcept {
  const double stiffness = law.stiffness_nm_per_rad;
  const double towards_rad_s = asks_ * at.velocity_rad_s;
  const double balance_nm = springNm(law, at);
  if (!std::isfinite(balance_nm)) return;
  load_nm_ += (balance_nm - load_nm_) * step_s / kBalanceS;
  // Drawn away, it meets the spring's own stiffness; and the place that leads it on goes no faster than the
  // limit.
  if (towards_rad_s < 0.0)
    load_nm_ -= stiffness * at.velocity_rad_s * step_s;
  else if (towards_rad_s > limit_rad_s)
    load_nm_ -= asks_ * stiffness * (towards_rad_s - limit_rad_s) * step_s;
  // Let go by what held it back, it carries nothing any more.
  if (letGo(at.velocity_rad_s, limit_rad_s, law.damping_nms_per_rad, step_s) && asks_ * load_nm_ > 0.0)
    load_nm_ = asks_ * std::max(asks_ * load_nm_ - most_nm * step_s / kLetGoS, 0.0);
  if (towards_rad_s < kLags * limit_rad_s) {
    const bool unwinds = asks_ * load_nm_ < 0.0;
    const double led_nm_s = stiffness * limit_rad_s;
    const double nm_s = unwinds ? std::min(most_nm / kUnwindS, std::max(led_nm_s, most_nm / kWholeS))
                                : std::min(most_nm / kWholeS, led_nm_s);
    load_nm_ += asks_ * nm_s * step_s;
  }
  load_nm_ = std::clamp(load_nm_, -most_nm, most_nm);
  if (asks_ == 0.0 || std::fabs(at.velocity_rad_s) >= kLags * limit_rad_s) carried_nm_ = load_nm_;
}

bool LeadBound::letGo(double velocity_rad_s, double limit_rad_s, double damping_nms_per_rad,
                      double step_s) noexcept {
  const double towards_rad_s = asks_ * velocity_rad_s;
  if (std::fabs(velocity_rad_s) < kStands * limit_rad_s) {
    stood_s_ += step_s;
    moved_s_ = 0.0;
  } else {
    moved_s_ += step_s;
    if (moved_s_ >= kMovesS) stood_s_ = 0.0;
  }
  if (!(std::fabs(velocity_rad_s) > kRuns * limit_rad_s)) return false;
  if (towards_rad_s > 0.0 && stood_s_ >= kStoodS) return true;
  stood_s_ = 0.0;
  return towards_rad_s > kSwing * std::fabs(load_nm_) / damping_nms_per_rad;
}

}  // namespace rc10
