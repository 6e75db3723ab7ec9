#pragma once

#include <algorithm>
#include <cmath>

#include "app/units.hpp"

namespace rc10 {

/// Between the speed of a wheel's tread and its revolutions. A radius that is not above 0 is no wheel:
/// both factors are 0, so that nothing moves.
struct WheelScale {
  double rpm_per_m_s = 0.0;
  double m_s_per_rpm = 0.0;

  [[nodiscard]] static WheelScale ofRadius(double radius_m) noexcept {
    if (!(radius_m > 0.0) || !std::isfinite(radius_m)) return {};
    const double m_s_per_rpm = kRadPerSPerRpm * radius_m;
    if (!std::isnormal(m_s_per_rpm)) return {};
    return {.rpm_per_m_s = 1.0 / m_s_per_rpm, .m_s_per_rpm = m_s_per_rpm};
  }
};

/// Commands to a chassis's wheels, or their feedback: a plain struct whose members are named by their
/// place, and which lists them in kAll for what is done to each of them alike.
template <typename Wheels>
concept WheelSet = requires(Wheels wheels) { wheels.*Wheels::kAll[0]; };

/// The speed in a member of a WheelSet: the member itself, unless its type has an overload of its own.
[[nodiscard]] constexpr double& speedOf(double& speed_rpm) noexcept { return speed_rpm; }

template <WheelSet Wheels>
[[nodiscard]] bool isFinite(Wheels wheels) noexcept {
  return std::ranges::all_of(Wheels::kAll,
                             [&wheels](auto wheel) { return std::isfinite(speedOf(wheels.*wheel)); });
}

template <WheelSet Wheels>
[[nodiscard]] Wheels scaled(Wheels wheels, double factor) noexcept {
  for (const auto wheel : Wheels::kAll) speedOf(wheels.*wheel) *= factor;
  return wheels;
}

/// The same wheels, all at speed 0.
template <WheelSet Wheels>
[[nodiscard]] Wheels stopped(Wheels wheels) noexcept {
  for (const auto wheel : Wheels::kAll) speedOf(wheels.*wheel) = 0.0;
  return wheels;
}

/// The wheels themselves, or all at speed 0 where one of them is not finite.
template <WheelSet Wheels>
[[nodiscard]] Wheels finiteOrRest(const Wheels& wheels) noexcept {
  return isFinite(wheels) ? wheels : stopped(wheels);
}

/// The speed of the fastest wheel, without sign.
template <WheelSet Wheels>
[[nodiscard]] double fastest(Wheels wheels) noexcept {
  double speed_rpm = 0.0;
  for (const auto wheel : Wheels::kAll) speed_rpm = std::fmax(speed_rpm, std::abs(speedOf(wheels.*wheel)));
  return speed_rpm;
}

/// No wheel faster than the limit: all are slowed by one factor, so that the robot drives the same path
/// more slowly. A limit of 0, below, or NaN allows nothing.
template <WheelSet Wheels>
[[nodiscard]] Wheels limited(const Wheels& wheels, double limit_rpm) noexcept {
  if (!isFinite(wheels) || !(limit_rpm > 0.0)) return stopped(wheels);
  const double speed_rpm = fastest(wheels);
  return speed_rpm <= limit_rpm ? wheels : scaled(wheels, limit_rpm / speed_rpm);
}

/// The mean speed over dt of a wheel whose multi-turn angle has changed. Odometry from these loses
/// nothing to the noise and quantisation of measured velocities. dt of 0, below, or NaN: 0.
[[nodiscard]] inline double meanRpm(double angle_before_deg, double angle_deg, float dt_s) noexcept {
  if (!(dt_s > 0.0F)) return 0.0;
  return (angle_deg - angle_before_deg) / (kDegPerSPerRpm * static_cast<double>(dt_s));
}

}  // namespace rc10
