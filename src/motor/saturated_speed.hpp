#pragma once

#include <chrono>
#include <cmath>

#include "app/time.hpp"

namespace rc10 {

/// Half a step of the coarsest field of a speed, twelve bits, as a share of its end.
inline constexpr double kHalfStepOfSpeed = 1.0 / 4096.0;

/// Speed of a drive whose field of the speed is cut off at its ends (RobStride, the motion mode of
/// MyActuator, maybe a CubeMars): there the way of the last samples says how much more it is, so that no
/// damping is underestimated. For the bounds of a command; readings keep the speed as it is told. Scheduler
/// thread only.
class SaturatedSpeed {
 public:
  explicit SaturatedSpeed(double end_rad_s) noexcept : end_rad_s_(kEndShare * end_rad_s) {}

  /// Takes a sample: position over turns, rad; `follows`: it continues that of the sample before.
  void add(double position_rad, bool follows, MonotonicTime received) noexcept {
    const Place place{position_rad, received};
    if (!follows || !std::isfinite(position_rad)) {
      from_ = next_ = place;
      way_rad_s_ = 0.0;
      return;
    }
    const Duration passed = received - from_.received;
    if (passed >= kWindow)
      way_rad_s_ = (position_rad - from_.position_rad) / std::chrono::duration<double>(passed).count();
    if (received - next_.received < kWindow) return;
    from_ = next_;
    next_ = place;
  }
  /// The told speed, or at an end of its field that of the way, if it is farther out.
  [[nodiscard]] double of(double told_rad_s) const noexcept {
    const bool at_end = std::fabs(told_rad_s) >= end_rad_s_;
    const bool farther = way_rad_s_ * told_rad_s > told_rad_s * told_rad_s;
    return at_end && farther ? way_rad_s_ : told_rad_s;
  }

 private:
  static constexpr double kEndShare = 1.0 - kHalfStepOfSpeed;
  // Stamps that come bunched are no speed over this time.
  static constexpr Duration kWindow = std::chrono::milliseconds{10};

  struct Place {
    double position_rad = 0.0;
    MonotonicTime received{};
  };

  double end_rad_s_;
  double way_rad_s_ = 0.0;  ///< 0: not known.
  Place from_;
  Place next_;
};

}  // namespace rc10
