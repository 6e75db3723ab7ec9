#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drives/myactuator/myactuator_frames.hpp"
#include "drives/myactuator/myactuator_setup.hpp"
#include "motor/drive_configuring.hpp"
#include "motor/enable_sequence.hpp"
#include "motor/frame_outbox.hpp"
#include "motor/saturated_speed.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// A MyActuator RMD-X motor. Its drive speaks only when asked: each command brings speed, current and
/// temperature in whole degrees per second and 0.01 A, and a second request the multi-turn angle in 0.01 deg.
/// Now and then it is asked for its errors and for how long it has been running: by that a restart is
/// noticed. It has no enabled state of its own: enabling is what makes sure that it runs, has no error and
/// obeys.
class MyActuator_Motor final : public SoloMotor {
 public:
  MyActuator_Motor(const MotorSettings& settings, const MotorTraits& traits);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;

  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;
  void clearComplaint() noexcept override;
  [[nodiscard]] DriveConfiguring* driveConfiguring() noexcept override { return &configuring_; }

 private:
  enum class Step : std::uint8_t { kStatus, kUptime, kReleaseBrake, kObey };

  void takeReading(const CanFrame& frame) noexcept;
  void takeSpeed(double output_rpm, bool of_motion) noexcept;
  FrameVerdict takeAngleReply(const CanFrame& frame) noexcept;
  void takeStatus(const CanFrame& frame) noexcept;
  void takeUptime(const CanFrame& frame) noexcept;
  FrameVerdict takeMotion(const CanFrame& frame) noexcept;
  [[nodiscard]] bool isCopyOfRequest(const CanFrame& frame) const noexcept;
  void watchSilence(MonotonicTime received) noexcept;
  void answered(Step step) noexcept;

  void sendCommand(const CanFrame& frame) noexcept;
  void poll(bool polled_before) noexcept;
  void sendQueries(const Tick& tick) noexcept;
  void runEnabling(const Tick& tick) noexcept;
  void beginEnabling() noexcept;
  [[nodiscard]] CanFrame stepFrame() const noexcept;
  void follow(const Target& target) noexcept;
  void followCurrent(const Target& target) noexcept;
  void followVelocity(double output_rpm) noexcept;
  void followAngle(double total_angle_deg) noexcept;
  void followImpedance(const Target& target) noexcept;
  void damp() noexcept;
  [[nodiscard]] double dampingOf() const noexcept;
  /// Bounded by what it measured last.
  void sendMotion(SpringLaw motion) noexcept;
  /// The drive's own multi-turn angle.
  [[nodiscard]] double measuredDeg() const noexcept {
    return static_cast<double>(raw_angle_.value_or(0)) * myactuator::kDegPerRaw;
  }

  int id_;
  MyactuatorSetupCodec setup_codec_{id_};
  DriveConfiguring configuring_{setup_codec_};
  int angle_divider_;
  bool release_brake_;
  std::array<FrameFilter, 2> filters_;
  std::array<CanId, 2> command_ids_;

  FrameOutbox outbox_;
  std::optional<CanFrame> last_command_;
  std::uint64_t turns_due_ = 0;  ///< Ticks in which it got a frame.
  bool polled_ = false;          ///< In the last of them FrameKind::kPoll was ordered.
  bool off_answered_ = false;    ///< The drive has answered, in this poll, that its output is off.
  MonotonicTime next_query_{};
  bool ask_uptime_ = false;  ///< The next question; else the status.
  bool reset_ = false;       ///< The drive is to be restarted with the next frames.

  // Readings of the drive.
  std::optional<MonotonicTime> heard_;
  std::optional<std::int32_t> raw_angle_;  ///< The last, in 0.01 deg.
  std::int64_t angle_raw_ = 0;             ///< The same, going on where 32 bits end.
  std::optional<double> motion_rad_;       ///< Angle of a motion answer since then.
  bool zero_before_ = false;               ///< The reply before said 0.
  bool speed_of_motion_ = false;           ///< Its scale is that of the motion mode.
  SaturatedSpeed speed_;                   ///< Beyond the end of that scale.
  bool running_ = false;                   ///< It has been the same run of the drive since angles were taken.
  std::optional<std::uint32_t> uptime_ms_;
  MonotonicTime uptime_at_{};
  std::uint16_t errors_ = 0;
  bool restarted_ = false;        ///< While it was to obey.
  bool silence_stopped_ = false;  ///< Its protection against silence struck while it was to obey.

  EnableSequence<Step> enabling_;
};

}  // namespace rc10
