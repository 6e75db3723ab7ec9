#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "app/vocabulary.hpp"

namespace rc10 {

/// Farther from 0 a double is coarser than an encoder (0.0001 deg), and moves no longer end.
inline constexpr double kFarthestAngleDeg = 1e12;

/// Whether a target of this mode means nothing while the angle has no reference.
[[nodiscard]] constexpr bool needsReference(ControlMode mode) noexcept {
  return mode == ControlMode::kAngle || mode == ControlMode::kTotalAngle || mode == ControlMode::kImpedance;
}

/// Whether the value of a target means something in this mode.
[[nodiscard]] constexpr bool usesValue(ControlMode mode) noexcept {
  return mode != ControlMode::kCoast && mode != ControlMode::kBrake;
}

/// A set of control modes.
class ModeSet {
 public:
  constexpr ModeSet() = default;
  template <typename... Modes>
  explicit constexpr ModeSet(Modes... modes) noexcept : bits_((0U | ... | bit(modes))) {}
  [[nodiscard]] constexpr ModeSet without(ControlMode mode) const noexcept {
    ModeSet rest = *this;
    rest.bits_ &= ~bit(mode);
    return rest;
  }
  [[nodiscard]] constexpr ModeSet operator&(ModeSet other) const noexcept {
    other.bits_ &= bits_;
    return other;
  }
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }
  [[nodiscard]] constexpr bool contains(ControlMode mode) const noexcept { return (bits_ & bit(mode)) != 0; }

 private:
  static constexpr std::uint32_t bit(ControlMode mode) noexcept { return 1U << static_cast<unsigned>(mode); }
  std::uint32_t bits_ = 0;
};

/// One order to one motor, at the output shaft. Goes through the command ring as it is.
struct Target {
  ControlMode mode = ControlMode::kCoast;
  double value = 0.0;  ///< In the unit of the mode.
  float velocity_ff_rpm = 0.0F;
  float torque_ff_nm = 0.0F;
  float stiffness_nm_per_rad = 0.0F;
  float damping_nms_per_rad = 0.0F;
};
static_assert(std::is_trivially_copyable_v<Target>);

/// Whether its value is a place that the shaft is led to. An impedance without stiffness is at none.
[[nodiscard]] constexpr bool actsByPlace(const Target& target) noexcept {
  return needsReference(target.mode) &&
         (target.mode != ControlMode::kImpedance || target.stiffness_nm_per_rad > 0.0F);
}

/// Fields of a target, beside its value, that a mode uses.
struct TargetFields {
  bool velocity_ff = false;
  bool torque_ff = false;
  bool spring = false;  ///< Stiffness and damping.
};

[[nodiscard]] constexpr TargetFields fieldsOf(ControlMode mode) noexcept {
  switch (mode) {
    case ControlMode::kCurrent:
    case ControlMode::kVelocity: return {.torque_ff = true};
    case ControlMode::kAngle:
    case ControlMode::kTotalAngle: return {.velocity_ff = true, .torque_ff = true};
    case ControlMode::kImpedance: return {.velocity_ff = true, .torque_ff = true, .spring = true};
    case ControlMode::kCoast:
    case ControlMode::kVoltage:
    case ControlMode::kDuty:
    case ControlMode::kBrake: break;
  }
  return {};
}

/// The same target with 0 in the fields that its mode does not use, for nothing may move a shaft past the
/// limits that act on its mode, and in optional fields that are not given (NaN).
[[nodiscard]] inline Target normalised(Target target) noexcept {
  const TargetFields used = fieldsOf(target.mode);
  const auto given = [](bool is_used, float field) { return is_used && !std::isnan(field) ? field : 0.0F; };
  if (!usesValue(target.mode)) target.value = 0.0;
  target.velocity_ff_rpm = given(used.velocity_ff, target.velocity_ff_rpm);
  target.torque_ff_nm = given(used.torque_ff, target.torque_ff_nm);
  target.stiffness_nm_per_rad = given(used.spring, target.stiffness_nm_per_rad);
  target.damping_nms_per_rad = given(used.spring, target.damping_nms_per_rad);
  return target;
}

}  // namespace rc10
