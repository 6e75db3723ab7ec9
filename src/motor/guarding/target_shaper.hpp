#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "app/limits.hpp"
#include "app/target.hpp"
#include "motor/motor_base.hpp"

namespace rc10 {

/// The approach to a soft limit, of the angle loop's gain, which is stable: a motor with three times the
/// inertia it was tuned for still stops before the limit.
inline constexpr float kApproachOfAngleGain = 0.5F;

/// Likewise for the spacing of samples and commands: share of the way left that may pass before the next
/// command.
inline constexpr float kApproachOfSpacing = 0.5F;

/// Slew limit and range of a target. At the output shaft; 0: no slew limit.
struct ShapingConfig {
  float effort_slew_per_s = 0.0F;  ///< A/s or V/s, as the drive is commanded.
  float velocity_slew_rpm_per_s = 0.0F;
  float angle_slew_deg_per_s = 0.0F;
  double angle_min_deg = -std::numeric_limits<double>::infinity();  ///< Soft limits of the total angle.
  double angle_max_deg = std::numeric_limits<double>::infinity();
  float approach_rpm_per_deg = 0.0F;  ///< Speed allowed towards a soft limit, per degree before it.
  float feedback_period_s = 0.0F;     ///< With command_period_s it bounds that approach; 0: no bound.
  float command_period_s = 0.0F;
  float approach_effort_per_rpm = 0.0F;  ///< Effort allowed towards it, per rpm below the allowed speed.
  bool approach_effort_is_gain = false;  ///< It is the proportional gain of the velocity loop on the host.
  float effort_per_rpm = 0.0F;           ///< Effort that only keeps up a speed: 0 for A, back-EMF for V.
  float effort_per_nm = 0.0F;            ///< A per N·m: of a torque feed-forward. 0: unknown.
  float effort_full_scale = 0.0F;        ///< Effort of a duty of 1. 0: unknown.
  float duty_per_rpm = 0.0F;             ///< Duty that only keeps up a speed. 0: unknown.
  float effort_limit = 0.0F;             ///< Limit of the motor, at which slews and soft starts end. 0: none.
  float velocity_limit_rpm = 0.0F;       ///< The same for the speed.
  bool has_velocity_loop = false;        ///< The motor can be told a speed.
  bool lead_is_speed = false;            ///< The lead of an angle is a speed: another loop bounds it.
  bool springs = false;                  ///< The drive makes torque by a SpringLaw, without an integral.
  double max_first_step_deg = std::numeric_limits<double>::infinity();
  float soft_start_s = 0.0F;  ///< The first target after enabling comes into force over this time.

  /// An effort is known that brakes a shaft which is too fast.
  [[nodiscard]] bool knowsBrakingEffort() const noexcept {
    return approach_effort_per_rpm > 0.0F || effort_per_rpm > 0.0F;
  }
};

/// Turns what a client asks for into what the motor may do in this tick: slew limits, and soft angle
/// limits that still allow moving back. Soft limits act while the angle is referenced, and with
/// MotorFeedback::bounds_only. After enabling the target in force goes from the measured to the asked value:
/// a client may have sent for long. A load that is held then is not let go: the target begins at the angle
/// and with the effort that a fallback holds.
///
/// Soft limits, a ceiling and the limit of the effort take away an effort, and brake, at once; an effort that
/// they took away comes back at its slew. Scheduler thread only.
class TargetShaper {
 public:
  explicit TargetShaper(const ShapingConfig& config) noexcept
      : config_(config),
        soft_limits_(std::isfinite(config.angle_min_deg) || std::isfinite(config.angle_max_deg)) {
    boundApproach();
  }

  /// Last command to the drive.
  struct InForce {
    float value = 0.0F;
    CommandUnit unit = CommandUnit::kNone;
    bool limited = false;  ///< By the limit of the effort: what was asked for was more.
    /// Angle that a fallback holds, to which the value is the effort; NaN: none.
    double held_deg = std::numeric_limits<double>::quiet_NaN();
    float duty = std::numeric_limits<float>::quiet_NaN();  ///< As the drive reports it; NaN: it does not.
  };
  /// Whether a target of this mode goes on from the last step. One that does not begins from `in_force`,
  /// which is otherwise of use only where it is limited.
  [[nodiscard]] bool follows(ControlMode mode) const noexcept { return mode == mode_; }
  /// Shapes `target`; the set of LimitFlag that act. `dt_s`: since the last step.
  [[nodiscard]] std::uint32_t step(Target& target, const MotorFeedback& feedback, const InForce& in_force,
                                   float dt_s) noexcept;
  /// The same for a stop, which is never soft.
  [[nodiscard]] std::uint32_t slowDown(Target& target, const MotorFeedback& feedback, const InForce& in_force,
                                       float dt_s) noexcept;
  [[nodiscard]] bool hasSoftLimits() const noexcept { return soft_limits_; }
  /// In each tick, before a step, where hasSoftLimits(): beyond a late sample the shaft has gone on.
  void reckon(const MotorFeedback& feedback, MonotonicTime now) noexcept;
  /// Speeds beyond which no loop is to push the shaft on: those of the soft limits and of the ceiling, and in
  /// a stop from `from_rpm` those between it and standstill; each with a tolerance for what a loop overshoots
  /// by. Infinite: no bound.
  [[nodiscard]] OutputRange speedBounds(const MotorFeedback& feedback, std::optional<double> from_rpm,
                                        double standstill_rpm) const noexcept;
  /// After a change of the loops' gains: see kApproachOfAngleGain.
  void setGains(float angle_kp, float velocity_kp) noexcept {
    config_.approach_rpm_per_deg = kApproachOfAngleGain * angle_kp;
    boundApproach();
    if (config_.approach_effort_is_gain) config_.approach_effort_per_rpm = velocity_kp;
  }
  /// Speed that no target of any mode leads beyond; infinite: none. A shaft that is faster is braked by
  /// targets of a speed or an angle, and by efforts.
  void setCeiling(double rpm) noexcept {
    if (rpm == ceiling_rpm_) return;  // as nearly always
    const bool comes = std::isfinite(rpm) && !reduced();
    if (comes) ceiling_nm_ = std::fabs(torque_ff_nm_);
    enters_ = std::isfinite(rpm) && (enters_ || comes);
    ceiling_rpm_ = rpm;
  }
  /// The next target starts from what is measured then.
  void reset() noexcept { mode_ = ControlMode::kCoast; }
  /// The motor is being enabled: the next targets start softly, from what is measured then.
  void restart() noexcept {
    reset();
    share_ = config_.soft_start_s > 0.0F ? 0.0 : 1.0;
  }

  /// Whether an angle target that follows none is close enough to the measured angle, by the way that its
  /// soft limits leave; likewise a spring that follows a softer one, and an angle that follows a spring.
  /// `before`: the last target.
  [[nodiscard]] bool firstStepAllowed(const Target& asked, const Target& before,
                                      const MotorFeedback& feedback) const noexcept;

 private:
  /// Speeds that still stop before the soft limits: low_rpm <= 0 <= high_rpm.
  struct Envelope {
    double low_rpm;
    double high_rpm;
  };
  /// Bounds of an angle target: the soft limits, or the place beyond one from which the shaft comes back.
  struct Travel {
    double low_deg = 0.0;
    double high_deg = 0.0;
  };
  [[nodiscard]] bool bounded(const MotorFeedback& feedback) const noexcept {
    return soft_limits_ && (feedback.zeroed || feedback.bounds_only);
  }
  [[nodiscard]] Envelope envelope(double total_angle_deg) const noexcept;
  void boundApproach() noexcept;
  [[nodiscard]] bool reduced() const noexcept { return std::isfinite(ceiling_rpm_); }
  [[nodiscard]] Envelope softEnvelope(const MotorFeedback& feedback) const noexcept;
  /// Bounds of the soft limits, where there are any, and of the ceiling.
  [[nodiscard]] Envelope allowedSpeeds(const MotorFeedback& feedback) const noexcept;
  /// Limit whose allowed speed this is.
  [[nodiscard]] LimitFlag limitOf(double allowed_rpm) const noexcept {
    return std::fabs(allowed_rpm) == ceiling_rpm_ ? kLimitVelocity : kLimitAngle;
  }
  /// The most in the direction of `sign`, for an effort without soft limits.
  [[nodiscard]] double effortTowards(double allowed_rpm, double sign,
                                     const MotorFeedback& feedback) const noexcept;
  [[nodiscard]] std::uint32_t shorten(Target& shaped, double before_deg, const MotorFeedback& feedback,
                                      float dt_s) noexcept;
  [[nodiscard]] double effortFor(double allowed_rpm, const MotorFeedback& feedback) const noexcept;
  [[nodiscard]] double reachable(double goal_deg, bool any_turn, const Travel& travel) const noexcept;
  void followFromOutside(const MotorFeedback& feedback) noexcept;
  /// The soft limits as bounds, farther out where the shaft or value_ is beyond one.
  void openTravel(double here_deg) noexcept;
  void begin(const Target& target, const MotorFeedback& feedback, const InForce& in_force) noexcept;
  void takeOver(const Target& target, const MotorFeedback& feedback, const InForce& in_force) noexcept;
  void soften(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept;
  [[gnu::noinline]] void stiffen(const Target& asked, const MotorFeedback& feedback) noexcept;
  void boundAsked(Target& asked) const noexcept;
  [[nodiscard]] bool slew(double goal, float per_second, float dt_s) noexcept;
  // Each shapes its part of the target and returns the limits that act.
  [[nodiscard]] std::uint32_t shape(Target& asked, const MotorFeedback& feedback, const InForce& in_force,
                                    float dt_s) noexcept;
  /// A speed or an angle.
  [[nodiscard]] std::uint32_t shapeMotion(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept;
  // Not inlined: shape() is short for a target without slew limits, soft limits and feed-forward.
  [[nodiscard, gnu::noinline]] std::uint32_t shapeWithFeedForward(Target& asked,
                                                                  const MotorFeedback& feedback,
                                                                  float dt_s) noexcept;
  [[nodiscard]] std::uint32_t shapeVelocityFf(Target& asked, float dt_s) noexcept;
  [[nodiscard]] std::uint32_t shapeTorqueFf(Target& asked, const MotorFeedback& feedback,
                                            float dt_s) noexcept;
  [[nodiscard]] double mostTorqueFf(bool springs, const MotorFeedback& feedback, double allowed_rpm,
                                    double sign) const noexcept;
  [[nodiscard]] double torqueUnderCeiling(const MotorFeedback& feedback, float dt_s) noexcept;
  [[nodiscard, gnu::noinline]] std::uint32_t shapeEffort(Target& asked, const MotorFeedback& feedback,
                                                         const InForce& in_force, float dt_s) noexcept;
  [[nodiscard]] std::uint32_t boundBySpeed(Target& asked, const MotorFeedback& feedback) noexcept;
  [[nodiscard, gnu::noinline]] std::uint32_t shapeVelocity(Target& asked, const MotorFeedback& feedback,
                                                           float dt_s) noexcept;
  [[nodiscard]] std::uint32_t shapeAngle(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept;
  /// shapeAngle() with a slew limit, soft limits or a ceiling.
  [[nodiscard, gnu::noinline]] std::uint32_t boundAngle(Target& asked, const MotorFeedback& feedback,
                                                        float dt_s) noexcept;

  ShapingConfig config_;
  bool soft_limits_;                   ///< On one side at least.
  double approach_rpm_per_deg_ = 0.0;  ///< ShapingConfig's, within what the spacing allows.
  double late_s_ = 0.0;                ///< Age of a sample from which it is late.
  std::uint64_t samples_ = 0;
  double fastest_rpm_ = 0.0;  ///< Measured by the last sample, or told since.
  double unseen_deg_ = 0.0;   ///< Most that the shaft has gone since a late sample; 0: it is not late.
  ControlMode mode_ = ControlMode::kCoast;  ///< Mode of the last step.
  double value_ = 0.0;                      ///< The slewed target of that mode.
  Travel travel_;
  double velocity_ff_rpm_ = 0.0;  ///< Slewed, too.
  double torque_ff_nm_ = 0.0;
  double stiffness_nm_per_rad_ = 0.0;  ///< Stiffness of the last step.
  bool feeds_forward_ = false;         ///< One of them is not 0.
  double ceiling_rpm_ = std::numeric_limits<double>::infinity();
  double ceiling_nm_ = 0.0;           ///< Torque feed-forward that the ceiling leaves.
  bool speed_bounds_effort_ = false;  ///< In place of an effort a speed is told.
  bool enters_ = false;               ///< A ceiling has come, and no angle was led under it.
  double share_ = 1.0;                ///< Share of the soft start that is over; 1: all.
  double soft_ = 0.0;        ///< Place of a soft start on its way to what is asked, in the unit of the mode.
  double soft_ff_nm_ = 0.0;  ///< The same of the torque feed-forward.
};

}  // namespace rc10
