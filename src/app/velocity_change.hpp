#pragma once

#include <array>

#include "app/profile_state.hpp"

namespace rc10 {

/// The fastest way from a velocity and an acceleration to another velocity without acceleration, with
/// limited acceleration and jerk: up to three pieces of constant jerk, and one before them where the
/// acceleration begins beyond its limit.
///
/// Limits above 0.
class VelocityChange {
 public:
  VelocityChange(const ProfileState& from, double to_velocity, double acceleration_limit,
                 double jerk_limit) noexcept;

  [[nodiscard]] double durationSeconds() const noexcept { return duration_s_; }
  /// Where it ends.
  [[nodiscard]] const ProfileState& end() const noexcept { return end_; }
  /// The state after t_s >= 0; after the end it goes on with the velocity it has reached.
  [[nodiscard]] ProfileState at(double t_s) const noexcept;

 private:
  struct Piece {
    double duration_s = 0.0;
    double jerk = 0.0;
  };
  [[nodiscard]] static ProfileState after(const ProfileState& from, double jerk, double t_s) noexcept;

  ProfileState start_;
  ProfileState end_;
  std::array<Piece, 4> pieces_{};
  double duration_s_ = 0.0;
};

}  // namespace rc10
