#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "bus/command_packer.hpp"
#include "motor/angle_reference.hpp"
#include "motor/bus_parts.hpp"
#include "motor/motor_base.hpp"
#include "motor/motor_settings.hpp"
#include "motor/motor_traits.hpp"
#include "motor/speed_scale_check.hpp"

namespace rc10 {

/// A motor whose drive has frames of its own: it listens and it packs. Common to most families: conversion
/// to the output shaft, the reference of the angle, the rhythm of commands, the meaning of an order.
/// A family adds updateFeedback(), update() and the packing. Scheduler thread only.
class SoloMotor : public Motor_Base, public CommandPacker {
 public:
  /// Native code of kDriveSetting: above it, the reported speed in percent of that of the angle.
  static constexpr std::uint32_t kSpeedScaleComplaint = 0x8000'0000;

  [[nodiscard]] std::string_view packerName() const noexcept override { return name(); }
  [[nodiscard]] double get_GearRatio() const noexcept override { return gear_ratio_; }
  [[nodiscard]] std::string_view modelName() const noexcept override { return model_; }
  [[nodiscard]] ModeSet modes() const noexcept override { return traits_.modes; }
  [[nodiscard]] const DriveFrames& driveFrames() const noexcept override { return traits_.frames; }
  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return feedback_period_; }
  [[nodiscard]] bool speaksUnasked() const noexcept override { return !traits_.asked; }
  bool setZero(double angle_deg) noexcept override;
  [[nodiscard]] double zeroForFile() const noexcept final { return reference_.zeroForFile(); }
  [[nodiscard]] double heldAngleDeg() const noexcept final {
    return holding_ ? hold_deg_ : std::numeric_limits<double>::quiet_NaN();
  }
  void forgetReference() noexcept override;
  [[nodiscard]] bool due(const Tick& tick) const noexcept final;
  void onUnsent() noexcept final { unsent_ = true; }

 protected:
  /// `drive_turns`: turns of what the drive reports per turn of the output shaft. get_GearRatio() where it
  /// reports its rotor, get_GearRatio() over the model's own where it reports its own output.
  SoloMotor(const MotorSettings& settings, const MotorTraits& traits, double drive_turns);

  // Conversion, direction included.
  [[nodiscard]] double toOutput(double drive_angle_or_speed) const noexcept {
    return drive_angle_or_speed / drive_per_output_;
  }
  [[nodiscard]] double toDrive(double output_angle_or_speed) const noexcept {
    return output_angle_or_speed * drive_per_output_;
  }
  [[nodiscard]] double torqueToOutput(double drive_torque_nm) const noexcept {
    return drive_torque_nm * drive_per_output_;
  }
  [[nodiscard]] double torqueToDrive(double output_torque_nm) const noexcept {
    return output_torque_nm / drive_per_output_;
  }
  [[nodiscard]] float direction() const noexcept { return drive_per_output_ < 0.0 ? -1.0F : 1.0F; }

  /// One sample: counts it, and takes the drive's position (deg, going on over turns) into the angles.
  /// `tells_angle` false: its whole turns are not known yet, AngleReference::drift().
  void acceptSample(MonotonicTime received, double drive_position_deg, bool tells_angle = true) noexcept;
  /// The same position, but not a sample: its place among the drive's turns has become known.
  void takeAngle(double drive_position_deg, bool tells_angle = true) noexcept;
  /// The position that the drive is to be told for a total angle.
  [[nodiscard]] double drivePositionFor(double total_angle_deg) const noexcept {
    return toDrive(reference_.positionFor(total_angle_deg));
  }
  /// The reported speed does not fit the change of the angle: for complaint() where nothing is graver.
  /// Families with MotorTraits::scaled_speed; compared while the motor obeys, until the scale is known.
  [[nodiscard]] DriveComplaint scaleComplaint() const noexcept;
  /// Highest speed that the field has room for, at the drive: exactly there it may be cut off, and says
  /// nothing of the scale.
  void speedFieldEndsAt(double rad_s) noexcept { speed_field_end_rpm_ = rad_s / kRadPerSPerRpm; }
  /// From now on the speed comes from another field.
  void compareSpeedAnew() noexcept { speed_scale_.reset(); }
  /// The drive was restarted or turns may have gone uncounted.
  void loseReference() noexcept;
  /// It may have been off, and turned meanwhile, though its count goes on.
  void doubtTurn() noexcept;

  /// The order has DriveDuty::kObey.
  [[nodiscard]] bool obeying() const noexcept { return dutyOf(ordered()) == DriveDuty::kObey; }
  [[nodiscard]] bool enabling() const noexcept { return dutyOf(ordered()) == DriveDuty::kEnable; }
  /// First tick of the present order; from wanted() on.
  [[nodiscard]] bool begins() const noexcept { return begins_; }
  /// A tick has begun the enable sequence: from now on frames of the drive are answers to it.
  [[nodiscard]] bool sequenceRuns() const noexcept { return enabling() && told_ == FrameKind::kEnable; }
  /// sequenceProgress() for this progress of the family's enable sequence; pending between the order and the
  /// tick in which the sequence begins.
  [[nodiscard]] SequenceProgress progressOf(SequenceProgress sequence) const noexcept {
    if (!enabling()) return SequenceProgress::kDone;
    return sequenceRuns() ? sequence : SequenceProgress::kPending;
  }

  /// Target that the order amounts to: the client's while kCommand, a standstill for kBrake, the angle where
  /// it began for kHold (kTotalAngle), else kCoast. kAngle (shortest way) is resolved to the total angle.
  /// To be called once in each update().
  [[nodiscard]] Target wanted() noexcept;

  /// Whether the measured current is within 5 % of its limit, or of the end of what the drive can report;
  /// `count_a`: step of the field, A, the least margin.
  [[nodiscard]] bool currentAtLimit(double count_a) const noexcept;
  /// The same of one of MotorTraits::own_loops, whose limit no derating lowers; never where it is unknown.
  [[nodiscard]] bool ownLoopAtLimit(double count_a) const noexcept;
  /// The same of another limit, A: that of the drive.
  [[nodiscard]] bool currentAtLimit(double limit_a, double count_a) const noexcept;

  // A target within the limits of the motor; what they cut off is told in limits_. Not a number: 0.
  /// Current of the mode kCurrent, with the feed-forward that comes with any mode. A at the motor.
  [[nodiscard]] double currentWithinLimit(const Target& target) noexcept;
  /// N·m at the output shaft.
  [[nodiscard]] double torqueWithinLimit(double nm) noexcept;
  [[nodiscard]] double rpmWithinLimit(double output_rpm) noexcept;
  /// The same, where the drive itself ends at `drive_limit_rpm` of the output shaft.
  [[nodiscard]] double rpmWithinLimit(double output_rpm, double drive_limit_rpm) noexcept;

  /// Command sent, for the state and the guards. Output shaft. A target may be any number: see nearFloat().
  void setCommand(double value, CommandUnit unit) noexcept {
    command_value_ = nearFloat(value);
    command_unit_ = unit;
  }

  [[nodiscard]] const MotorTraits& traits() const noexcept { return traits_; }
  [[nodiscard]] float effortLimit() const noexcept { return effort_limit_ * derating(); }
  /// The same as torque: at the output shaft, and at the drive's own output. 0 where N·m/A are unknown.
  [[nodiscard]] double torqueLimitNm() const noexcept {
    return static_cast<double>(effortLimit()) * static_cast<double>(torqueNmPerA());
  }
  [[nodiscard]] double driveTorqueLimitNm() const noexcept {
    return std::abs(torqueToDrive(torqueLimitNm()));
  }
  /// A at the motor to N·m at the output shaft; the drive's current and this sign agree.
  [[nodiscard]] float torqueNmPerA() const noexcept { return torque_nm_per_a_; }
  /// 0: none.
  [[nodiscard]] float velocityLimitRpm() const noexcept { return velocity_limit_rpm_; }
  /// Period of a tick.
  [[nodiscard]] Duration tickPeriod() const noexcept { return tick_period_; }
  /// Spacing of its commands.
  [[nodiscard]] Duration commandPeriod() const noexcept {
    return static_cast<Duration::rep>(divider_) * tick_period_;
  }

 private:
  [[nodiscard]] Target resolved() noexcept;
  /// The reference has been lost, doubted or forgotten: a loss if it `was_known`.
  void noteLoss(bool was_known) noexcept;
  /// A limit of the current, as far as the drive reports it.
  [[nodiscard]] double reportable(float limit_a) const noexcept;

  std::string model_;
  MotorTraits traits_;
  double gear_ratio_;
  double drive_per_output_;  ///< Signed by the direction.
  float effort_limit_;
  float own_limit_a_;
  float velocity_limit_rpm_;
  float torque_nm_per_a_;
  Duration tick_period_;
  Duration feedback_period_;
  std::uint64_t divider_;
  std::uint64_t phase_;
  AngleReference reference_;
  SpeedScaleCheck speed_scale_;
  double speed_field_end_rpm_ = std::numeric_limits<double>::max();
  FrameKind told_ = FrameKind::kRest;  ///< The order of the last tick.
  bool begins_ = false;
  bool led_ = false;          ///< By a fallback, in the last tick.
  bool unsent_ = false;       ///< A frame since the last update() was not sent.
  bool out_of_turn_ = false;  ///< begins(), led otherwise than in the last tick, or unsent_ then.
  bool holding_ = false;
  bool follows_angle_ = false;  ///< By the target of the last tick.
  double hold_deg_ = 0.0;
};

/// Turns of a drive's own output, on which it reports, per turn of the output shaft.
[[nodiscard]] double driveTurns(const MotorSettings& settings, const MotorTraits& traits) noexcept;

/// Ranges of the gains of impedance targets in the drive's frames, at the output shaft.
[[nodiscard]] SpringRange springRangeOf(const MotorSettings& settings, const MotorTraits& traits) noexcept;

/// Settings with the feedback rate of a drive that only answers, with its angle once in `commands` answers.
[[nodiscard]] MotorSettings withFeedbackOfCommands(MotorSettings settings, int commands);

/// Registers both halves of a motor with its bus: what most families build() with.
template <typename Motor>
[[nodiscard]] Result<std::unique_ptr<Motor_Base>> registerSolo(std::unique_ptr<Motor> motor,
                                                               BusParts& parts) {
  if (auto listens = parts.bus().registerMotor(static_cast<FrameListener&>(*motor)); !listens) {
    return tl::unexpected(listens.error());
  }
  if (auto packs = parts.bus().registerMotor(static_cast<CommandPacker&>(*motor)); !packs) {
    return tl::unexpected(packs.error());
  }
  return std::unique_ptr<Motor_Base>(std::move(motor));
}

}  // namespace rc10
