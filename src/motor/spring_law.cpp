#include "motor/spring_law.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

double gainWithin(double value, double most) noexcept { return value > 0.0 ? std::min(value, most) : 0.0; }

bool clampTo(double& value, double low, double high) noexcept {
  const double bounded = std::clamp(value, low, high);
  const bool changed = bounded != value;
  value = bounded;
  return changed;
}

}  // namespace

bool SpringRange::has(float gain_nm_per_rad, float gain_nms_per_rad) const noexcept {
  // At the shaft it is that of the frame times the square of a gear ratio: rounded as the gains are.
  const auto within = [](float gain, double most) {
    return gain >= 0.0F && gain <= static_cast<float>(most);
  };
  return !(stiffness_nm_per_rad > 0.0) ||
         (within(gain_nm_per_rad, stiffness_nm_per_rad) && within(gain_nms_per_rad, damping_nms_per_rad));
}

double torqueNm(const SpringLaw& law, const SpringState& at) noexcept {
  double spring_nm = 0.0;
  double damper_nm = 0.0;
  if (law.stiffness_nm_per_rad > 0.0) {
    spring_nm = law.stiffness_nm_per_rad * (law.position_rad - at.position_rad);
  }
  if (law.damping_nms_per_rad > 0.0) {
    damper_nm = law.damping_nms_per_rad * (law.velocity_rad_s - at.velocity_rad_s);
  }
  return spring_nm + damper_nm + law.torque_nm;
}

void keepResisting(SpringLaw& law, double step_nms_per_rad) noexcept {
  const double steps = law.damping_nms_per_rad / step_nms_per_rad;
  if (law.resists && steps >= 0.5 && steps < 1.0) law.damping_nms_per_rad = step_nms_per_rad;
}

void boundGains(SpringLaw& law, double stiffness_nm_per_rad, double damping_nms_per_rad) noexcept {
  law.stiffness_nm_per_rad = gainWithin(law.stiffness_nm_per_rad, stiffness_nm_per_rad);
  law.damping_nms_per_rad = gainWithin(law.damping_nms_per_rad, damping_nms_per_rad);
}

bool boundLead(SpringLaw& law, const SpringState& at, double low_rad_s, double high_rad_s) noexcept {
  if (!(law.stiffness_nm_per_rad > 0.0 && law.damping_nms_per_rad > 0.0)) return false;
  const double rad_per_rad_s = law.damping_nms_per_rad / law.stiffness_nm_per_rad;
  return clampTo(law.position_rad, at.position_rad + rad_per_rad_s * low_rad_s,
                 at.position_rad + rad_per_rad_s * high_rad_s);
}

bool boundParts(SpringLaw& law, const SpringState& at, double most_nm) noexcept {
  if (law.resists) return false;
  bool changed = false;
  if (law.stiffness_nm_per_rad > 0.0) {
    const double most_rad = most_nm / law.stiffness_nm_per_rad;
    changed = clampTo(law.position_rad, at.position_rad - most_rad, at.position_rad + most_rad);
  }
  if (law.damping_nms_per_rad > 0.0) {
    const double most_rad_s = most_nm / law.damping_nms_per_rad;
    changed |= clampTo(law.velocity_rad_s, at.velocity_rad_s - most_rad_s, at.velocity_rad_s + most_rad_s);
  }
  return changed;
}

bool boundTorque(SpringLaw& law, const SpringState& at, double most_nm, SpringYield yields) noexcept {
  const double torque_nm = torqueNm(law, at);
  if (!(std::fabs(torque_nm) > most_nm)) return false;
  const double share = most_nm / std::fabs(torque_nm);
  const double excess_nm = torque_nm - std::copysign(most_nm, torque_nm);
  switch (law.resists ? SpringYield::kGains : yields) {
    case SpringYield::kErrors:
      law.position_rad = at.position_rad + share * (law.position_rad - at.position_rad);
      law.velocity_rad_s = at.velocity_rad_s + share * (law.velocity_rad_s - at.velocity_rad_s);
      law.torque_nm *= share;
      break;
    case SpringYield::kGains:
      law.stiffness_nm_per_rad *= share;
      law.damping_nms_per_rad *= share;
      law.torque_nm *= share;
      break;
    case SpringYield::kTarget:
      if (law.stiffness_nm_per_rad > 0.0) {
        law.position_rad -= excess_nm / law.stiffness_nm_per_rad;
      } else if (law.damping_nms_per_rad > 0.0) {
        law.velocity_rad_s -= excess_nm / law.damping_nms_per_rad;
      } else {
        law.torque_nm -= excess_nm;
      }
      break;
  }
  return true;
}

}  // namespace rc10
