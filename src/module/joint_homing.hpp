#pragma once

#include <cstdint>
#include <limits>

#include "app/time.hpp"

namespace rc10 {

/// Finds the end of an axis: first away from it, to see that the axis moves at all, then towards it until it
/// stands against the stop or the switch closes, back, and once more at half the velocity. All by a current
/// that is bounded, so that the stop is met gently: near the homing velocity the current goes to 0, and
/// beyond it brakes. A light axis with slow feedback gets as little current as it needs.
///
/// A standstill alone is no stop: gravity or friction may balance the current anywhere. The stop is no nearer
/// than where the axis began, is pressed with the full current, and is no farther than the travel allows. It
/// is met twice at the same place, and so is the switch: one wrong sample of it is no end.
class JointHoming {
 public:
  enum class Way : std::uint8_t { kStop, kSwitch };
  struct Config {
    Way way = Way::kStop;
    double velocity_rpm = 0.0;   ///< Towards the end; its sign says where that is.
    double current_a = 0.0;      ///< Bound of the current.
    double away_deg = 0.0;       ///< Distance that it moves away: first, and between the two meetings.
    double tolerance_deg = 1.0;  ///< Between the two meetings, and in a standstill.
    /// From the end to the far soft limit; infinite: not known.
    double travel_deg = std::numeric_limits<double>::infinity();
    Duration stopped{};  ///< Standstill that is the stop.
    Duration timeout{};
  };
  struct Measured {
    double total_angle_deg = 0.0;
    double velocity_rpm = 0.0;
    double current_a = 0.0;  ///< NaN: not told, so not pressed.
    /// Speed that the reduced mode leaves the motor; infinite: all.
    double speed_ceiling_rpm = std::numeric_limits<double>::infinity();
    bool at_switch = false;
    bool switch_heard = true;  ///< Homing ends without it: the axis would run over the end.
    MonotonicTime received{};  ///< Time of the sample: a standstill lasts from sample to sample.
    MonotonicTime now{};
  };
  enum class Progress : std::uint8_t {
    kUnderWay,
    kFound,
    kFailed,  ///< In time nothing was found, or it cannot be seen.
    kNoStop,  ///< It stood still, but not at the end, or there is none within the travel.
  };

  explicit JointHoming(const Config& config) noexcept : config_(config) {}

  void start(const Measured& measured) noexcept;
  [[nodiscard]] Progress step(const Measured& measured) noexcept;
  /// Current for the motor, A.
  [[nodiscard]] double current() const noexcept { return current_a_; }

 private:
  enum class Phase : std::uint8_t { kAway, kTowards, kBackOff, kAgain };
  /// State of a shaft that the current pushes.
  enum class Standstill : std::uint8_t {
    kNone,
    kPressed,  ///< It stands still under the full current.
    kGivenUp,  ///< It stands still, and the full current does not come.
  };

  void begin(Phase phase, const Measured& measured) noexcept;
  [[nodiscard]] Progress end(Progress outcome) noexcept;
  [[nodiscard]] Progress goAway(const Measured& measured) noexcept;
  [[nodiscard]] Progress goTowards(const Measured& measured) noexcept;
  [[nodiscard]] Progress meet(const Measured& measured) noexcept;
  void push(double velocity_rpm, const Measured& measured) noexcept;
  void adapt(double missing, double gained, double pushed_a) noexcept;
  /// `direction`: of the current, 1: towards the end.
  [[nodiscard]] Standstill standstill(const Measured& measured, double direction) noexcept;
  /// Speed of the homing, or as much of it as the reduced mode leaves.
  [[nodiscard]] double velocityRpm(const Measured& measured) const noexcept;
  /// Way from `from_deg` to `to_deg`, positive towards the end.
  [[nodiscard]] double towards(double from_deg, double to_deg) const noexcept;

  Config config_;
  Phase phase_ = Phase::kAway;
  double start_deg_ = 0.0;
  double left_deg_ = 0.0;   ///< Where it last began to go away.
  double met_deg_ = 0.0;    ///< Where it met the end first.
  bool went_away_ = false;  ///< Else it began at its far end, or it does not move at all.
  MonotonicTime started_{};
  MonotonicTime moved_{};   ///< Sample before which it moved.
  double still_deg_ = 0.0;  ///< Place of that sample.
  double most_a_ = 0.0;     ///< The current towards its goal since then, and
  MonotonicTime rose_{};    ///< the time at which it rose last.
  double current_a_ = 0.0;
  double share_ = 0.0;       ///< Part of the full push that is in use.
  MonotonicTime pushed_{};   ///< Sample after which it was last adapted,
  double pushed_rpm_ = 0.0;  ///< and the velocity of that.
};

}  // namespace rc10
