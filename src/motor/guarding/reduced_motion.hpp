#pragma once

#include <cstdint>
#include <limits>

#include "app/time.hpp"
#include "motor/motor_base.hpp"

namespace rc10 {

/// Limits of a motor while a person is near: SLS, safely-limited speed, of IEC 61800-5-2, without its safety
/// integrity. At the output shaft.
struct ReducedConfig {
  float velocity_rpm = 0.0F;                 ///< 0: the speed is not reduced.
  float effort_share = 1.0F;                 ///< Share of the effort limit; 1: not reduced.
  Duration within{std::chrono::seconds{1}};  ///< A shaft that is faster after that is a fault.
  float slew_rpm_per_s = 0.0F;               ///< On the way down; 0: half of `within`.
  float tolerance_rpm = 0.0F;                ///< Tolerance of the monitored speed, above velocity_rpm.
  float full_rpm = 0.0F;                     ///< From here the speed is limited no more.

  [[nodiscard]] bool any() const noexcept { return velocity_rpm > 0.0F || effort_share < 1.0F; }
};

/// Speed and effort that one motor may have: reduced at once or along a ramp, full again within
/// kLiftSeconds.
/// Scheduler thread only.
class ReducedMotion {
 public:
  /// Time in which speed and effort come back in full: nothing gains speed in a jump.
  static constexpr float kLiftSeconds = 1.0F;

  explicit ReducedMotion(const ReducedConfig& config) noexcept : config_(config), any_(config.any()) {}

  /// A motor at rest; one that only resists what drags it; one that follows a target or a fallback.
  enum class Motion : std::uint8_t { kNone, kResisted, kLed };

  /// Once a tick. The monitored time begins with the motion, with `reduced`, and after a resistance that
  /// lasted, or under which a slow shaft became fast. True: a motor that is led is faster than it may be,
  /// after the monitored time. Only where there is any().
  [[nodiscard]] bool step(bool reduced, Motion motion, const MotorFeedback& feedback,
                          const Tick& tick) noexcept;
  /// Whether anything is ever reduced.
  [[nodiscard]] bool any() const noexcept { return any_; }

  /// Bound of every target's speed; infinite: none.
  [[nodiscard]] double ceilingRpm() const noexcept { return ceiling_rpm_; }
  /// For Motor_Base::derate().
  [[nodiscard]] float effortShare() const noexcept { return share_; }

 private:
  [[nodiscard]] bool endsResistance(Motion motion, const MotorFeedback& feedback, MonotonicTime now) noexcept;
  void begin(const MotorFeedback& feedback, MonotonicTime now) noexcept;
  void reduce(const MotorFeedback& feedback, const Tick& tick) noexcept;
  [[nodiscard]] bool fast(const MotorFeedback& feedback) const noexcept;
  void lift(float dt_s) noexcept;
  [[nodiscard]] bool tooFast(const MotorFeedback& feedback) noexcept;

  ReducedConfig config_;
  bool any_;  ///< config_.any()
  double ceiling_rpm_ = std::numeric_limits<double>::infinity();
  double fall_rpm_per_s_ = 0.0;
  float share_ = 1.0F;
  bool acts_ = false;        ///< Reduced, of a motor that moves.
  bool comes_down_ = false;  ///< Faster than it may be, within the monitored time.
  MonotonicTime since_{};
  bool resisted_ = false;       ///< In the last tick.
  bool resisted_fast_ = false;  ///< It was already fast as the resistance began.
  MonotonicTime resisted_since_{};
  std::uint64_t samples_ = 0;
  int fast_samples_ = 0;
};

}  // namespace rc10
