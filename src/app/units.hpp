#pragma once

#include <compare>
#include <numbers>

namespace rc10 {

/// A quantity in the project's one unit for it. The constructor is explicit, so that a bare number
/// (the users' firmware passes milliamperes) does not compile where a target is expected.
template <typename Tag>
struct Quantity {
  double value = 0.0;

  constexpr Quantity() = default;
  constexpr explicit Quantity(double v) noexcept : value(v) {}

  constexpr Quantity operator-() const noexcept { return Quantity{-value}; }
  friend constexpr bool operator==(Quantity, Quantity) = default;
  friend constexpr auto operator<=>(Quantity, Quantity) = default;
};

using Amperes = Quantity<struct AmperesTag>;
using Volts = Quantity<struct VoltsTag>;
using Rpm = Quantity<struct RpmTag>;
using Degrees = Quantity<struct DegreesTag>;

/// Between units: `rad = deg * kRadPerDeg`.
inline constexpr double kDegPerTurn = 360.0;
inline constexpr double kRadPerTurn = 2.0 * std::numbers::pi;
inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kDegPerSPerRpm = 6.0;
inline constexpr double kRadPerSPerRpm = std::numbers::pi / 30.0;
inline constexpr double kRpmPerRadPerS = 30.0 / std::numbers::pi;
inline constexpr double kRpmPerTurnPerS = 60.0;

/// Torque constant (N·m/A, of the peak of the phase current) times KV (rpm/V, of the peak between two phases)
/// of a star winding: 1.5 * pole pairs * flux linkage, and 60 / (sqrt(3) * 2 pi * pole pairs * flux linkage).
inline constexpr double kTorqueTimesKv = 1.5 / std::numbers::sqrt3 * kRpmPerRadPerS;

namespace literals {
// NOLINTBEGIN(readability-identifier-naming): the unit's own symbol reads best.
constexpr Amperes operator""_A(long double v) noexcept { return Amperes{static_cast<double>(v)}; }
constexpr Amperes operator""_A(unsigned long long v) noexcept { return Amperes{static_cast<double>(v)}; }
constexpr Amperes operator""_mA(long double v) noexcept { return Amperes{static_cast<double>(v) / 1000.0}; }
constexpr Amperes operator""_mA(unsigned long long v) noexcept {
  return Amperes{static_cast<double>(v) / 1000.0};
}
constexpr Volts operator""_V(long double v) noexcept { return Volts{static_cast<double>(v)}; }
constexpr Volts operator""_V(unsigned long long v) noexcept { return Volts{static_cast<double>(v)}; }
constexpr Rpm operator""_rpm(long double v) noexcept { return Rpm{static_cast<double>(v)}; }
constexpr Rpm operator""_rpm(unsigned long long v) noexcept { return Rpm{static_cast<double>(v)}; }
constexpr Degrees operator""_deg(long double v) noexcept { return Degrees{static_cast<double>(v)}; }
constexpr Degrees operator""_deg(unsigned long long v) noexcept { return Degrees{static_cast<double>(v)}; }
// NOLINTEND(readability-identifier-naming)
}  // namespace literals

}  // namespace rc10
