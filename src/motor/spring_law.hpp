#pragma once

#include <cstdint>

namespace rc10 {

/// Control law that a drive computes by itself, at its own output ("MIT", operation or motion control):
/// torque = stiffness * (position - its own) + damping * (velocity - its own) + torque.
/// Nothing but the drive's current bounds that sum, so the numbers that it is told have to.
struct SpringLaw {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double stiffness_nm_per_rad = 0.0;
  double damping_nms_per_rad = 0.0;
  double torque_nm = 0.0;
  /// Damping alone, of damp and brake: it opposes the shaft at any speed, also long after its last frame.
  bool resists = false;
};

/// Most that a drive's fields for gains can say, from 0 up; 0: it has none.
struct SpringRange {
  double stiffness_nm_per_rad = 0.0;
  double damping_nms_per_rad = 0.0;

  /// Whether it has these gains of a target; a range of 0 has all.
  [[nodiscard]] bool has(float gain_nm_per_rad, float gain_nms_per_rad) const noexcept;
};

/// The drive's output as it was measured last, in the drive's own count.
struct SpringState {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
};

/// Part of a law that gives way to a bound of its torque.
enum class SpringYield : std::uint8_t {
  kErrors,  ///< Both errors and the torque shrink together: damping stays as stiff as it was.
  kGains,   ///< Stiffness, damping and torque shrink together: position and velocity stay as they were asked.
  kTarget,  ///< The position, or without stiffness the velocity, comes nearer: the torque stays.
};

/// Torque that the drive makes of a law. A part without a gain is 0.
[[nodiscard]] double torqueNm(const SpringLaw& law, const SpringState& at) noexcept;

/// Law of damp and brake.
[[nodiscard]] constexpr SpringLaw resistance(double damping_nms_per_rad) noexcept {
  return {.damping_nms_per_rad = damping_nms_per_rad, .resists = true};
}

/// The law for where no angle may be followed: it opposes the shaft with the greater damping, and pushes
/// nothing.
[[nodiscard]] constexpr SpringLaw dampOnly(const SpringLaw& law, double damping_nms_per_rad) noexcept {
  return resistance(law.damping_nms_per_rad > damping_nms_per_rad ? law.damping_nms_per_rad
                                                                  : damping_nms_per_rad);
}

/// A field that rounds down would leave a fast shaft without a brake: one step of it, where that is nearer
/// than none.
void keepResisting(SpringLaw& law, double step_nms_per_rad) noexcept;

/// Gains between 0 and those that a frame can say; not a number: 0.
void boundGains(SpringLaw& law, double stiffness_nm_per_rad, double damping_nms_per_rad) noexcept;

// Each returns whether it changed the law. Of one that resists nothing but the damping yields: with a
// speed, the drive would turn the shaft when frames stop.

/// Position so near that the speed at which spring and damper balance is between `low_rad_s` and `high_rad_s`
/// beyond the law's own velocity. Nothing without damping.
[[nodiscard]] bool boundLead(SpringLaw& law, const SpringState& at, double low_rad_s,
                             double high_rad_s) noexcept;
/// Spring and damper each within +-`most_nm`: neither uses up what the other has.
[[nodiscard]] bool boundParts(SpringLaw& law, const SpringState& at, double most_nm) noexcept;
/// The sum within +-`most_nm`, from what was measured last.
[[nodiscard]] bool boundTorque(SpringLaw& law, const SpringState& at, double most_nm,
                               SpringYield yields) noexcept;

}  // namespace rc10
