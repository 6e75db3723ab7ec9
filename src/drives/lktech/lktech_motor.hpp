#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drives/lktech/lktech_frames.hpp"
#include "motor/enable_sequence.hpp"
#include "motor/frame_outbox.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// An LK-Tech motor. Its drive sends nothing but replies, under the id of the command: only the payload tells
/// a reply from somebody else's command. The reply to a command has current, speed and the encoder of the
/// output; now and then the drive is asked for its errors and for the turns that it has counted itself, by
/// which a restart is noticed.
///
/// As a member of an LKTech_Group it leaves its currents to the group, and sends only what else there is.
class LKTech_Motor final : public SoloMotor {
 public:
  LKTech_Motor(const MotorSettings& settings, const MotorTraits& traits);

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

  // For its group.
  [[nodiscard]] int driveId() const noexcept { return id_; }
  [[nodiscard]] bool grouped() const noexcept { return grouped_; }
  /// Result of update() in the drive's unit; isDue(): it is sent in this tick.
  [[nodiscard]] int rawCurrent() const noexcept { return raw_current_; }
  [[nodiscard]] bool isDue() const noexcept { return due_; }

 private:
  enum class Step : std::uint8_t { kStatus, kTurnOn, kTurns, kObey };

  [[nodiscard]] bool isReply(const CanFrame& frame) const noexcept;
  [[nodiscard]] FrameVerdict verdictOnCommand() const noexcept;
  void takeReading(const CanFrame& frame) noexcept;
  void takeStatus(const CanFrame& frame) noexcept;
  void takeTurns(const CanFrame& frame) noexcept;
  void doubtCount() noexcept;
  [[nodiscard]] bool countsAfresh(double angle_deg) const noexcept;
  void answered(Step step) noexcept;
  [[nodiscard]] double encoderDeg(std::uint16_t raw) const noexcept;

  void sendCurrent(int raw) noexcept;
  void sendQueries(const Tick& tick) noexcept;
  void runEnabling(const Tick& tick) noexcept;
  void beginEnabling() noexcept;
  void sendStep() noexcept;
  void follow(const Target& target) noexcept;
  void followCurrent(const Target& target) noexcept;
  void followVelocity(double output_rpm) noexcept;
  void followAngle(double total_angle_deg) noexcept;
  void release() noexcept;
  [[nodiscard]] int rawOf(double amperes) const noexcept;
  /// Copy of our own frame that switches the drive on.
  [[nodiscard]] bool copiesOurs(const CanFrame& frame) const noexcept;

  int id_;
  bool grouped_;
  double amperes_per_raw_;
  std::uint16_t encoder_mask_;
  std::array<FrameFilter, 1> filters_;
  std::array<CanId, 1> command_ids_;

  FrameOutbox outbox_;
  int raw_current_ = 0;
  bool due_ = false;
  MonotonicTime next_query_{};
  bool ask_turns_ = false;  ///< The next question; else the status.
  bool clear_ = false;
  std::optional<MonotonicTime> switched_on_;  ///< When the drive was last told to.

  // Readings of the drive.
  std::optional<MonotonicTime> heard_;
  std::optional<std::uint16_t> encoder_;
  double position_deg_ = 0.0;  ///< Position of the drive's output, in the drive's own count of turns.
  double shift_deg_ = 0.0;     ///< The drive's multi-turn angle less that.
  bool shift_known_ = false;   ///< That was seen while it stood, or is too large for anything else.
  bool counted_ = false;       ///< The turns are known, and since then it has not been silent.
  bool was_counted_ = false;   ///< They were before the last silence.
  int zero_angles_ = 0;        ///< Replies in a row with an angle of 0.
  bool off_ = false;
  std::uint8_t errors_ = 0;
  bool restarted_ = false;  ///< While it was to obey: its turns are lost.

  EnableSequence<Step> enabling_;
};

}  // namespace rc10
