#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "app/time.hpp"
#include "motor/fault_code.hpp"
#include "motor/motor_base.hpp"

namespace rc10 {

/// Too fast in so many samples in a row: one strange sample is not a speed.
inline constexpr int kFastSamples = 3;

/// Limits of a motor beyond which it is stopped. At the output shaft; 0: not watched.
struct GuardConfig {
  float overspeed_rpm = 0.0F;
  float temperature_derate_c = 0.0F;  ///< From here on the effort limit comes down, to 0 at the trip.
  float temperature_trip_c = 0.0F;
  Duration stall_time{};
  float stall_rpm = 0.0F;   ///< Slower than this, and at its effort limit: it does not turn.
  bool stall_trips = true;  ///< false: only the limit flag.
  double following_error_deg = 0.0;
  Duration following_error_time{};  ///< Without a break.
  bool encoder_jumps = false;       ///< One is a fault.
  float frozen_a = 0.0F;            ///< The reported current is off by more, and nothing changes at all.
  float runaway_rpm = 0.0F;         ///< Gains so much speed against all its torque.
  Duration runaway_time{};  ///< Time for which the gained speed lasts before it is a fault; targets of the
                            ///< drive's own loop only.
  float velocity_limit_rpm = 0.0F;  ///< Bounds what a target asks for; 0: none.

  [[nodiscard]] bool any() const noexcept {
    return overspeed_rpm > 0.0F || temperature_trip_c > 0.0F || stall_time > Duration{0} ||
           following_error_deg > 0.0 || encoder_jumps || frozen_a > 0.0F || runaway_rpm > 0.0F;
  }
};

/// Watches one ACTIVE motor for what should not be. Scheduler thread only.
class MotorGuard {
 public:
  /// State of the motor in this tick, before its update().
  struct Observation {
    const MotorFeedback& feedback;
    const Target& target;  ///< In force since the last tick.
    float effort = 0.0F;   ///< Last command to the drive.
    CommandUnit unit = CommandUnit::kNone;
    std::uint32_t limits = 0;  ///< Limits of the last update().
    MonotonicTime now;
  };
  struct Verdict {
    FaultCode fault = FaultCode::kNone;
    float derating = 1.0F;     ///< For Motor_Base::derate().
    std::uint32_t limits = 0;  ///< Set of LimitFlag: what acts or is noticed right now.
  };

  explicit MotorGuard(const GuardConfig& config) noexcept : config_(config), watches_(config.any()) {}

  [[nodiscard]] Verdict step(const Observation& seen) noexcept { return watches_ ? look(seen) : Verdict{}; }
  /// Too hot for any torque; not, where the drive reports no temperature.
  [[nodiscard]] bool tooHot(const MotorFeedback& feedback) const noexcept {
    return config_.temperature_trip_c > 0.0F && feedback.temperature_c >= config_.temperature_trip_c;
  }
  /// The motor is not ACTIVE, or was not: nothing from before counts but its heat.
  void reset() noexcept;
  [[nodiscard]] const GuardConfig& config() const noexcept { return config_; }

 private:
  /// Time for which a condition has held while somebody looked: of a pause of the process little counts.
  class Lasting {
   public:
    void reset() noexcept { held_.reset(); }
    [[nodiscard]] bool step(bool so, MonotonicTime now, Duration enough) noexcept {
      const Duration since_step = now - stepped_at_;
      stepped_at_ = now;
      if (!so) {
        held_.reset();
        return false;
      }
      held_ = held_ ? *held_ + std::min(since_step, kLongestStep) : Duration{0};
      return *held_ >= enough;
    }

   private:
    // Two periods of the slowest rate_hz.
    static constexpr Duration kLongestStep = std::chrono::milliseconds{20};

    std::optional<Duration> held_;
    MonotonicTime stepped_at_{};
  };

  /// Readings that no moving shaft repeats to the last bit.
  struct Readings {
    double total_angle_deg = 0.0;
    float velocity_rpm = 0.0F;
    float current_a = 0.0F;
    float temperature_c = 0.0F;
  };
  [[nodiscard]] static bool same(const Readings& a, const Readings& b) noexcept;

  [[nodiscard]] Verdict look(const Observation& seen) noexcept;
  [[nodiscard]] FaultCode motionFault(const Observation& seen, bool new_sample) noexcept;
  [[nodiscard]] bool tooFast(const MotorFeedback& feedback, bool new_sample) noexcept;
  [[nodiscard]] bool stalled(const Observation& seen) noexcept;
  [[nodiscard]] bool fallsBehind(const Observation& seen) noexcept;
  [[nodiscard]] bool frozen(const Observation& seen, bool new_sample) noexcept;
  [[nodiscard]] bool runsAway(const Observation& seen) noexcept;
  /// Distance to the target of an angle mode, 0 in others.
  [[nodiscard]] static double errorDeg(const Observation& seen) noexcept;
  /// Its speed is one that its target asks for.
  [[nodiscard]] bool moveIsAsked(const Observation& seen) const noexcept;
  /// Since it gained it, its speed has neither turned nor come down: what an own current, which back-EMF
  /// lowers, no longer tells.
  [[nodiscard]] bool keepsGain(float velocity_rpm, bool gained) noexcept;
  void forgetGain() noexcept;
  void followLoop(bool of_effort, ControlMode mode) noexcept;
  [[nodiscard]] float factorAt(float temperature_c) const noexcept;
  [[nodiscard]] float derate(float temperature_c, MonotonicTime now) noexcept;

  GuardConfig config_;
  bool watches_;
  bool begun_ = false;
  std::uint64_t samples_ = 0;  ///< Count of the feedback in the last step.
  Readings last_;              ///< The sample before.
  std::uint64_t jumps_ = 0;
  float derating_ = 1.0F;
  MonotonicTime derated_at_{};  ///< Last step of it.
  int fast_samples_ = 0;
  bool unchanged_ = false;
  bool opposed_ = false;
  float opposed_rpm_ = 0.0F;  ///< Speed when torque began to oppose it.
  bool of_effort_ = true;     ///< The command is a current or a voltage, not a target of the drive's loop.
  ControlMode loop_mode_ = ControlMode::kCoast;
  float gained_rpm_ = 0.0F;        ///< The fastest since it has run away, with its sign; 0: it has not.
  float gained_current_a_ = 0.0F;  ///< The strongest that opposed it meanwhile.
  Lasting runaway_;
  Lasting stall_;
  Lasting behind_;
  Lasting frozen_;
};

}  // namespace rc10
