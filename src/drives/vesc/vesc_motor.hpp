#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "app/pid_position.hpp"
#include "drives/vesc/vesc_frames.hpp"
#include "drives/vesc/vesc_inquiry.hpp"
#include "drives/vesc/vesc_model.hpp"
#include "motor/sample_spacing.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// A motor behind a VESC. The drive closes current, speed and, with an encoder, position; an angle from the
/// tachometer is closed here, with speeds to the drive. Any command moves the motor: there is no enabling in
/// the drive, so the enable sequence only asks whether it is well and has a watchdog.
///
/// In velocity, angle and duty the drive's own limits bound the current, not the configured ones.
class VESC_Motor : public SoloMotor {
 public:
  explicit VESC_Motor(const MotorSettings& settings);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;

  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;
  bool setZero(double angle_deg) noexcept override;
  [[nodiscard]] float reportedDuty() const noexcept override;
  [[nodiscard]] const CascadeConfig* hostLoops() const noexcept override {
    return own_.angle == VescAngle::kTachometer ? &loops_ : nullptr;
  }
  void retune(const CascadeConfig& loops) noexcept override;

  [[nodiscard]] bool watchdogProven() const noexcept { return inquiry_.watchdogProven(); }

 private:
  struct Command {
    vesc::Packet packet = vesc::Packet::kSetCurrent;
    std::int32_t raw = 0;
  };

  void takeStatus1(const CanFrame& frame) noexcept;
  void takePosition(MonotonicTime received, double moved_deg, bool known) noexcept;
  void takeSteps(const CanFrame& frame) noexcept;
  void takeEncoder(const CanFrame& frame) noexcept;
  /// Degrees of the drive's encoder since the last sample.
  struct Way {
    double moved = 0.0;
    double off = 0.0;  ///< Distance from where the speed has taken it.
    bool doubtful = false;
  };
  [[nodiscard]] Way wayTo(double now_deg, Duration gap) const noexcept;
  [[nodiscard]] Way wayOver(double now_deg, Duration spacing) const noexcept;
  void restarted() noexcept;
  /// STATUS_1 is not older than the patience with a drive.
  [[nodiscard]] bool status1Fresh(MonotonicTime now) const noexcept;
  [[nodiscard]] bool gapTooLong(Duration gap) const noexcept;

  void follow(const Target& target) noexcept;
  void release() noexcept;
  void followCurrent(const Target& target) noexcept;
  void seeOwnLimit() noexcept;
  void setVelocity(double rpm) noexcept;
  void setPosition(double total_angle_deg) noexcept;
  /// Way of the encoder until the drive has newer commands from a newer sample.
  [[nodiscard]] double degUntilNextSample() const noexcept;
  void followDuty(double duty) noexcept;
  void damp() noexcept;
  void brake() noexcept;
  void followVelocity(const Target& target) noexcept;
  void followAngle(const Target& target) noexcept;
  [[nodiscard]] Command currentCommand(vesc::Packet absolute, vesc::Packet relative,
                                       double drive_a) const noexcept;
  [[nodiscard]] float stoppableRpm(float error_deg) const noexcept;
  [[nodiscard]] bool silent() const noexcept;
  [[nodiscard]] bool standsStill() noexcept;

  VescSettings own_;
  int id_;
  double rotor_per_output_;  ///< Signed by the direction.
  Duration patience_;        ///< Older feedback than this closes no loop.
  std::array<FrameFilter, 8> filters_;
  std::array<CanId, 10> command_ids_;
  // The last of each.
  vesc::Status1 status1_;
  vesc::Status4 status4_;
  vesc::Status5 status5_;
  VescInquiry inquiry_;
  CascadeConfig loops_;
  PID_Position angle_loop_;
  SampleSpacing spacing_;

  Command command_;
  MonotonicTime now_;
  MonotonicTime status1_at_;
  bool status1_seen_ = false;  ///< Since the drive started.
  bool position_seen_ = false;
  MonotonicTime position_at_{};
  bool restarted_ = false;
  bool locked_ = false;  ///< The handbrake holds.
  bool looping_ = false;
  bool limited_ = false;            ///< The angle loop runs into the velocity limit.
  double position_deg_ = 0.0;       ///< Position of the drive, going on over turns.
  double loop_position_deg_ = 0.0;  ///< Output, at the last step of the angle loop.
  double loop_rpm_ = 0.0;
};

}  // namespace rc10
