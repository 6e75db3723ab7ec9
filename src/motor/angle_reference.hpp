#pragma once

#include "motor/first_angle.hpp"

namespace rc10 {

/// Where a motor's angle is 0. Fed with the drive's position as an output-shaft angle that goes on over
/// turns and starts anywhere; total angle = that + offset. Scheduler thread only.
class AngleReference {
 public:
  struct Config {
    bool absolute = false;          ///< The drive's position means the same after every power-up.
    double zero_deg = 0.0;          ///< Absolute only: the position that is to read 0, until setZero().
    bool zero_at_power_on = false;  ///< The first position is 0, and known.
    Travel travel{};                ///< Absolute only: tells the turn at power-up.
  };

  explicit AngleReference(const Config& config) noexcept : config_(config) {}

  /// A new reference is a jump of the angle. `may_restart`: allowed once an unclear turn has become clear, as
  /// no target follows the angle. `may_return`: allowed after the reference was lost; without both limits the
  /// angle does not jump, so it is found at once.
  void update(double position_deg, bool may_restart = true, bool may_return = true) noexcept;
  /// A position that does not tell the angle yet, as whole turns of the count are unknown: the angle goes on
  /// by its way since the last, and nothing is found.
  void drift(double position_deg) noexcept;
  /// The present position reads `angle_deg` from now on. False before the first update().
  bool setZero(double angle_deg) noexcept;
  /// The angle goes on without a known reference until setZero(), whatever becomes of the drive meanwhile.
  void forget() noexcept;
  /// The drive may have lost turns: the angle goes on, but without a known reference. An absolute drive
  /// finds it again, once it may, in the frame of the last setZero(): on the turn of its travel, without one
  /// on that nearest to where it was.
  void lose() noexcept;
  /// The drive may have been off, and the shaft turned meanwhile: lose(). Only an absolute drive without a
  /// travel goes on, for it has no wrong turn.
  void doubtTurn() noexcept;

  [[nodiscard]] bool known() const noexcept { return known_; }
  /// Absolute, but its travel does not tell the turn.
  [[nodiscard]] bool turnUnclear() const noexcept { return turn_unclear_; }
  [[nodiscard]] double totalAngleDeg() const noexcept { return position_deg_ + offset_deg_; }
  /// Motor_Base::zeroForFile().
  [[nodiscard]] double zeroForFile() const noexcept;
  /// The drive's position at this total angle: for targets.
  [[nodiscard]] double positionFor(double total_angle_deg) const noexcept {
    return total_angle_deg - offset_deg_;
  }

 private:
  Config config_;
  bool begun_ = false;
  bool known_ = false;
  bool turn_unclear_ = false;
  bool lost_ = false;       ///< Absolute only.
  bool forgotten_ = false;  ///< Until setZero().
  bool drifts_ = false;     ///< The last position was that of drift(), and the reference not lost since.
  double position_deg_ = 0.0;
  double offset_deg_ = 0.0;
};

}  // namespace rc10
