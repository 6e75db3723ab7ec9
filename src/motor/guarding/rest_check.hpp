#pragma once

#include <cstdint>

#include "app/time.hpp"
#include "motor/motor_base.hpp"

namespace rc10 {

/// Evidence that a drive which is told to rest does not. At the output shaft.
struct RestConfig {
  float current_a = 0.0F;   ///< More than this is torque; 0: not watched, its feedback cannot tell.
  Duration time{};          ///< Without a break.
  float gained_rpm = 0.0F;  ///< Speed gained at rest that is worth a report; 0: none is.
};

/// Compares what a drive is told with what it reports while it is told to rest. Torque is a current that
/// drives the shaft on, or one without motion: what opposes the motion is a shorted winding, and speed alone
/// may be gravity, a slope or a hand. Scheduler thread only.
class RestCheck {
 public:
  enum class Verdict : std::uint8_t {
    kRests,
    kGainsSpeed,  ///< Something drives the shaft; reported once, until it stands still.
    kDriven,      ///< Its drive does; reported once, until it has rested.
  };

  explicit RestCheck(const RestConfig& config) noexcept : config_(config) {}

  /// Once a tick. `told`: its drive got rest frames, since the last tick at least.
  [[nodiscard]] Verdict step(const MotorFeedback& feedback, bool told, float standstill_rpm) noexcept {
    if (told) return look(feedback, standstill_rpm);
    if (told_) reset();
    return Verdict::kRests;
  }
  /// Verdicts that were reported may be reported again.
  void reset() noexcept;

 private:
  [[nodiscard]] Verdict look(const MotorFeedback& feedback, float standstill_rpm) noexcept;
  [[nodiscard]] float torqueSign(const MotorFeedback& feedback, float standstill_rpm) const noexcept;
  [[nodiscard]] bool driven(const MotorFeedback& feedback, float standstill_rpm) noexcept;
  [[nodiscard]] bool gains(const MotorFeedback& feedback, float standstill_rpm) noexcept;

  RestConfig config_;
  bool told_ = false;
  std::uint64_t seen_ = 0;  ///< Samples when it was last looked at.
  float sign_ = 0.0F;       ///< Sign of the current since `since_`; 0: it rests.
  MonotonicTime since_{};
  int samples_ = 0;  ///< Since then.
  bool driven_reported_ = false;
  float slowest_rpm_ = 0.0F;  ///< Since it was told to rest.
  bool gain_reported_ = false;
};

}  // namespace rc10
