#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "app/result.hpp"
#include "drives/dji/dji_model.hpp"
#include "motor/cascade.hpp"
#include "motor/encoder.hpp"
#include "motor/motor_base.hpp"
#include "motor/motor_settings.hpp"
#include "motor/sample_spacing.hpp"

namespace rc10 {

/// A DJI motor: decodes its feedback and runs its loops. Never packs: that is its DJI_Group's work.
///
/// Reference of the angle. M3508 and M2006 count from their first sample, with zeroed = false until
/// setZero(); a gap too long to know the turns makes that so again. GM6020 without a gear knows its
/// angle: zeroed from the first sample, total angle then in [-180, 180). After a gap too long its
/// turns are in doubt: without both limits it is at once on the turn nearest to where it was; with both
/// zeroed = false, without a jump, for as long as an angle is being controlled, then on that of its travel.
///
/// Loops advance on new samples only. After 100 ms without one they stop, and their effort is 0.
class DJI_Motor : public Motor_Base {
 public:
  /// The error names the motor, the key and the allowed range.
  [[nodiscard]] static Result<void> check(const MotorSettings& settings);

  /// `settings` have passed check().
  explicit DJI_Motor(const MotorSettings& settings) : DJI_Motor(settings, *findDjiModel(settings.model)) {}
  /// A drive with this table, which outlives it, whatever the settings call its model.
  DJI_Motor(const MotorSettings& settings, const DjiModel& model);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;

  [[nodiscard]] double get_GearRatio() const noexcept override { return gear_ratio_; }
  [[nodiscard]] std::string_view modelName() const noexcept override { return model_->name; }
  [[nodiscard]] ModeSet modes() const noexcept override;
  [[nodiscard]] const DriveFrames& driveFrames() const noexcept override;
  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return std::chrono::milliseconds{1}; }
  [[nodiscard]] bool speaksUnasked() const noexcept override { return true; }
  bool setZero(double angle_deg) noexcept override;
  void boundSpeeds(const OutputRange& speeds_rpm) noexcept override { loops_.boundSpeeds(speeds_rpm); }
  void dropWindup(float least_rpm) noexcept override;
  [[nodiscard]] double zeroForFile() const noexcept override;
  [[nodiscard]] double heldAngleDeg() const noexcept override {
    return holding_ ? hold_deg_ : std::numeric_limits<double>::quiet_NaN();
  }
  void forgetReference() noexcept override;
  void restoreReference(ControlMode followed) noexcept override;
  [[nodiscard]] const CascadeConfig* hostLoops() const noexcept override { return &loops_.config(); }
  void retune(const CascadeConfig& loops) noexcept override { loops_.retune(loops); }

  [[nodiscard]] const DjiModel& model() const noexcept { return *model_; }
  [[nodiscard]] DjiCommand command() const noexcept { return command_; }
  [[nodiscard]] int driveId() const noexcept { return id_; }
  /// The id of the frame that carries this motor's command, and its slot in it (0-3).
  [[nodiscard]] CanId commandId() const noexcept;
  [[nodiscard]] int slot() const noexcept { return djiSlot(id_); }
  /// Result of update() in the drive's unit: direction applied, clamped to full scale.
  [[nodiscard]] std::int16_t rawCommand() const noexcept;

 private:
  [[nodiscard]] const DjiCommandTable& table() const noexcept { return model_->command(command_); }
  void setReference(double total_angle_deg) noexcept;
  void updateAngles() noexcept;
  /// As the encoder counts: goes on over turns, starts anywhere.
  [[nodiscard]] double reportedAngleDeg() const noexcept {
    return static_cast<double>(encoder_.totalCounts()) * degrees_per_count_;
  }
  /// firstAngle(), of an angle that is right but for whole turns.
  void findTurn(double angle_deg, double near_deg) noexcept;
  /// Valid until the next call.
  [[nodiscard]] const Target& wantedTarget() noexcept;
  [[nodiscard]] Target damped() const noexcept;
  [[nodiscard]] Target held() noexcept;
  [[nodiscard]] bool silent() const noexcept;
  void runLoops(const Target& target, float sample_dt_s, float limit) noexcept;
  void releaseEffort() noexcept;

  const DjiModel* model_;
  int id_;
  DjiCommand command_;
  double gear_ratio_;
  int direction_;
  float effort_limit_;
  bool absolute_;  ///< The encoder sits on the output shaft.
  bool zero_at_power_on_;
  double zero_deg_;
  Travel travel_;
  std::array<FrameFilter, 1> filters_;
  Encoder encoder_;
  Cascade loops_;
  SampleSpacing spacing_;

  // Signed by the direction: one multiplication per value on receipt.
  double degrees_per_count_;
  float rpm_per_raw_;
  float amperes_per_raw_;
  float torque_nm_per_a_;
  float raw_per_effort_;
  float raw_full_scale_;
  float damping_a_per_rpm_;  ///< Damping of the shorted winding; 0 V have the same effect.

  // total angle = reference_deg_ + (counts - reference_counts_) * degrees_per_count_
  std::int64_t reference_counts_ = 0;
  double reference_deg_ = 0.0;
  double hold_deg_ = 0.0;
  bool holding_ = false;
  bool forgotten_ = false;         ///< forgetReference(), until setZero().
  std::uint64_t hold_losses_ = 0;  ///< Losses of the encoder, when the hold began.
  Target own_;                     ///< Target of an order that has none.
  float silence_s_ = 0.0F;         ///< Ticks since the last sample, in seconds.
};

/// The three models under the users' names: `M3508 wheel{settings}`. They differ only in their table.
class M3508 : public DJI_Motor {
 public:
  explicit M3508(const MotorSettings& settings) : DJI_Motor(settings, kM3508) {}
};
class M2006 : public DJI_Motor {
 public:
  explicit M2006(const MotorSettings& settings) : DJI_Motor(settings, kM2006) {}
};
class GM6020 : public DJI_Motor {
 public:
  explicit GM6020(const MotorSettings& settings) : DJI_Motor(settings, kGM6020) {}
};

}  // namespace rc10
