#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drives/odrive/odrive_frames.hpp"
#include "drives/odrive/odrive_model.hpp"
#include "motor/enable_sequence.hpp"
#include "motor/frame_outbox.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// A motor on an ODrive axis, commanded by CANSimple. The drive runs all loops; it reports its encoder's
/// shaft unasked, and counts turns by itself until it is restarted.
///
/// Enabling: idle, then torque control of 0 N·m, the limits, closed loop, until the heartbeat says so. It
/// clears no errors. A mode that changes later is told three times, since nothing reports it back.
class ODrive_Motor : public SoloMotor {
 public:
  /// Native code of kDriveSetting: telemetry_hz is written, and no current comes.
  static constexpr std::uint32_t kNoCurrentComplaint = 0x8000'0000;

  /// `settings` has passed its family's check().
  ODrive_Motor(const MotorSettings& settings, const MotorTraits& traits);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override {
    return std::span{filters_}.first(filter_count_);
  }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;

  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;
  void clearComplaint() noexcept override;

 private:
  /// Step of the enable sequence.
  enum class Step : std::uint8_t { kToIdle, kToClosedLoop };

  FrameVerdict takeHeartbeat(const CanFrame& frame) noexcept;
  FrameVerdict takeEstimates(const CanFrame& frame) noexcept;
  FrameVerdict takeTelemetry(const CanFrame& frame) noexcept;
  void hear(MonotonicTime received) noexcept;
  /// It has been heard for long enough without the current that telemetry_hz promises.
  [[nodiscard]] bool lacksCurrent() const noexcept;
  void forgetPosition() noexcept;
  [[nodiscard]] bool isJump(MonotonicTime received, double turns, double turns_per_s) const noexcept;

  void runEnabling(const Tick& tick) noexcept;
  [[nodiscard]] bool stateSince(odrive::AxisState state, MonotonicTime since) const noexcept;
  void watchState() noexcept;

  void follow(const Target& target) noexcept;
  void followCurrent(const Target& target) noexcept;
  void followVelocity(double rpm, float torque_ff_nm) noexcept;
  void followAngle(const Target& target) noexcept;
  void setInput(odrive::ControlMode mode, const CanFrame& input) noexcept;
  void refreshLimits(const Tick& tick) noexcept;
  [[nodiscard]] CanFrame limitsFrame() const noexcept;

  int node_;
  OdriveFirmware firmware_;
  float iq_sign_;
  std::array<FrameFilter, 5> filters_;
  std::size_t filter_count_;
  std::array<CanId, 7> command_ids_;

  // Heard.
  std::optional<odrive::Heartbeat> heartbeat_;
  MonotonicTime heartbeat_at_;
  MonotonicTime heard_at_;
  bool heard_ = false;
  bool starting_ = false;
  bool position_known_ = false;  ///< turns_ is of this drive's present life.
  double turns_ = 0.0;
  double turns_per_s_ = 0.0;
  MonotonicTime current_at_;
  Duration current_patience_;       ///< 0: none is due.
  MonotonicTime current_due_from_;  ///< When one came last, or the drive was heard anew.
  MonotonicTime temperature_at_;
  MonotonicTime voltage_at_;

  // Enabling.
  EnableSequence<Step> enabling_;
  bool ask_ = false;  ///< The step's frames are sent in this tick.
  bool stopped_ = false;

  // To be sent.
  odrive::ControlMode mode_ = odrive::ControlMode::kTorque;
  CanFrame input_;
  int mode_repeats_ = 0;
  int clear_repeats_ = 0;
  bool mode_known_ = false;
  bool limits_due_ = false;
  float limits_sent_a_ = 0.0F;
  MonotonicTime limits_sent_at_;
};

}  // namespace rc10
