#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "drives/moteus/moteus_frames.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// One moteus controller: a frame tells it what to do and asks for its readings, and it answers. Every frame
/// holds the whole command, because writing the mode resets all other command registers.
/// Scheduler thread only.
class Moteus_Motor final : public SoloMotor {
 public:
  /// `settings` has passed MotorFamily::check().
  Moteus_Motor(const MotorSettings& settings, const MotorTraits& traits);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;
  void dropWindup(float least_rpm) noexcept override;

  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;
  void clearComplaint() noexcept override;

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  /// Revolutions after which its position register goes round. Source: fw/bldc_servo_structs.h,
  /// control_position_raw.
  static constexpr double kRangeRev = 65536.0;

  /// Values of an answer to this driver's questions. Units of the drive.
  struct Reading {
    double mode = kNaN;
    double fault = kNaN;
    double position_rev = kNaN;
    double velocity_rev_s = kNaN;
    double torque_nm = kNaN;
    double current_a = kNaN;
    double voltage_v = kNaN;
    double temperature_c = kNaN;
    double clock_ms = kNaN;  ///< Modulo 65536.
    double version = kNaN;
    double home_state = kNaN;
    double timeout_s = kNaN;
    bool fine_position = false;  ///< As a float: integers do not reach over its range.
    bool has_clock = false;
  };
  /// Command in position mode. Units of the drive.
  struct Motion {
    double position_rev = kNaN;  ///< Where it is.
    double velocity_rev_s = 0.0;
    double torque_nm = 0.0;
    bool stiff = false;   ///< Position and integral gain act.
    bool damped = false;  ///< Velocity gain acts.
    /// Its own profile leads to the position, at no more than limit_rev_s (0: its own limit). Otherwise
    /// position and velocity act at once.
    bool profile = false;
    double limit_rev_s = 0.0;
  };
  enum class Send : std::uint8_t { kStop, kQuery, kIdentify, kVerify, kMotion, kBrake };
  enum class Step : std::uint8_t { kNone, kIdentify, kEngage, kVerify, kDone, kFailed };

  [[nodiscard]] static bool decode(const CanFrame& frame, Reading& reading) noexcept;
  [[nodiscard]] Duration shortestOff() const noexcept;
  [[nodiscard]] bool restarted(MonotonicTime received, double clock_ms) noexcept;
  [[nodiscard]] bool jumped(MonotonicTime received, const Reading& reading) const noexcept;
  void takePosition(double position_rev, bool anew) noexcept;
  void takeState(const Reading& reading) noexcept;
  void drop(FaultCode why, std::uint32_t native) noexcept;

  void runEnabling(const Tick& tick) noexcept;
  void enter(Step step, const Tick& tick) noexcept;
  void fail(FaultCode why, std::uint32_t native) noexcept;
  [[nodiscard]] Send restSend(const Tick& tick) const noexcept;
  void release() noexcept;
  void follow(const Target& target, const Tick& tick) noexcept;
  void followCurrent(const Target& target) noexcept;
  void followVelocity(const Target& target, const Tick& tick) noexcept;
  void followAngle(const Target& target) noexcept;
  [[nodiscard]] double boundedRpm(double rpm) noexcept;
  [[nodiscard]] double onWire(double position_rev) noexcept;

  [[nodiscard]] moteus::Writer writer() const noexcept;
  [[nodiscard]] CanFrame motionFrame() const noexcept;

  MoteusSettings own_;
  std::array<FrameFilter, 1> filters_;
  std::array<CanId, 1> command_ids_;
  double watchdog_s_;
  double slip_s_;  ///< For how long a speed may have gone on since the last reading.

  // The last answer.
  std::optional<MonotonicTime> answered_;
  moteus::Mode mode_ = moteus::Mode::kStopped;
  std::uint32_t native_fault_ = 0;
  std::optional<MonotonicTime> clock_read_;
  double clock_ms_ = 0.0;
  std::optional<Reading> identity_;   ///< The last that had a version in it.
  std::optional<double> verified_s_;  ///< The time-out that the drive says it was told.
  double position_rev_ = 0.0;         ///< Going on over the range of the register.
  double wire_rev_ = 0.0;             ///< position_rev_ minus what was on the wire.

  Send send_ = Send::kStop;
  Motion motion_;
  Step step_ = Step::kNone;
  MonotonicTime step_began_;
  bool engaged_ = false;
  bool clearing_ = false;
  DriveComplaint lost_;               ///< It left its mode while it was to obey.
  DriveComplaint refused_;            ///< Reason why enabling failed.
  std::optional<double> course_rev_;  ///< Velocity: where the shaft should be by now.
  float last_rpm_ = 0.0F;             ///< Speed in the last tick of a velocity target.
};

}  // namespace rc10
