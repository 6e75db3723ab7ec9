#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/limits.hpp"
#include "app/motor_readings.hpp"
#include "app/target.hpp"
#include "app/time.hpp"
#include "app/units.hpp"
#include "bus/frame_listener.hpp"
#include "motor/drive_frames.hpp"
#include "motor/fault_code.hpp"

namespace rc10 {

inline constexpr float kNotReported = std::numeric_limits<float>::quiet_NaN();

/// The last known state of a motor, at the output shaft, in the users' units. NaN: not reported.
struct MotorFeedback {
  MonotonicTime received;     ///< Time of the last accepted frame.
  std::uint64_t samples = 0;  ///< Frames accepted since start; 0: nothing here is known yet.
  std::uint64_t jumps = 0;    ///< Samples whose angle the motor cannot have reached.
  // angle_deg, total_angle_deg, velocity_rpm, …: app/motor_readings.hpp.
#define RC10_FIELD(type, name, initial) type name = std::numeric_limits<type>::quiet_NaN();
  RC10_FEEDBACK_READINGS(RC10_FIELD)
#undef RC10_FIELD
  bool zeroed = false;  ///< The angle has a known reference.
  bool bounds_only =
      false;  ///< It is known, but its drive can be told no place: soft limits alone act by it.
  bool zero_refused = false;  ///< Any zero: its drive's count of turns is in doubt.
  std::uint64_t losses = 0;   ///< Losses of a known reference, those that ended at once included.
  bool turn_unclear = false;  ///< Absolute, but its travel does not say on which turn it stands.
  bool angle_at_end = false;  ///< The drive's field ends here: the shaft may turn on, and nobody sees it.
};

struct CascadeConfig;
class DriveConfiguring;

/// One motor: setTarget...() takes targets, updateFeedback() decodes, update() computes. A CommandPacker,
/// the motor itself or its group, makes a frame of update()'s result.
/// Scheduler thread only.
class Motor_Base : public FrameListener {
 public:
  explicit Motor_Base(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }

  // Orders. A mode the motor does not support is refused: false, and the old target stays.
  bool setTarget(const Target& target) noexcept;
  /// Whether setTarget() takes it.
  [[nodiscard]] bool acceptsTarget(const Target& target) const noexcept;
  bool setTargetCurrent(Amperes current) noexcept;
  bool setTargetRPM(Rpm velocity) noexcept;
  bool setTargetAngle(Degrees angle) noexcept;
  bool setTargetTotalAngle(Degrees angle) noexcept;
  void clearTarget() noexcept { target_ = Target{}; }
  [[nodiscard]] const Target& target() const noexcept { return target_; }

  /// Kind of frame from this tick on: the supervisor's decision. kRest until the first one.
  void order(FrameKind kind) noexcept {
    ordered_ = kind;
    in_force_.reset();
    led_place_deg_ = std::numeric_limits<double>::quiet_NaN();
  }
  /// The same, with the target as bounded by the guards, for update() to follow. An optional field that is
  /// not finite becomes 0 here too, on purpose: nothing refuses an order, and the sum of a shaper may be one.
  void order(FrameKind kind, const Target& in_force) noexcept;
  /// order(kHold) on the way back to heldAngleDeg(), which stays. `led_deg`: total angle to hold in this
  /// tick, as bounded by the guards, finite.
  void orderHold(double led_deg) noexcept {
    order(FrameKind::kHold);
    led_place_deg_ = led_deg;
  }
  [[nodiscard]] FrameKind ordered() const noexcept { return ordered_; }

  /// Before a target of this mode is shaped and followed: a motor whose encoder is absolute, and which may
  /// have lost turns, knows its angle again. With a travel not while an angle is followed: its turn would be
  /// a jump. Asked for only while the angle has no known reference.
  virtual void restoreReference(ControlMode) noexcept {}

  /// Scales the effort limit from this tick on, by 0 (nothing) to 1 (all): a hot motor gets less.
  void derate(float factor) noexcept { derating_ = factor > 0.0F ? std::min(factor, 1.0F) : 0.0F; }

  /// Speeds at the output shaft, rpm, beyond which no loop of rc10d drives the shaft ever faster. Infinite:
  /// no bound.
  virtual void boundSpeeds(const OutputRange& speeds_rpm) noexcept { speeds_rpm_ = speeds_rpm; }
  /// Before a stop: ends the effort of a loop of rc10d against a blocked shaft, one with less than half of
  /// the speed asked for. A speed below `least_rpm` counts as none. Scheduler thread.
  virtual void dropWindup(float /*least_rpm*/) noexcept {}

  /// Computes the command of this tick from the order, the target and the feedback.
  virtual void update(const Tick& tick) noexcept = 0;
  /// Whether the command of this tick is to be sent. Sequences may send in other ticks, too.
  [[nodiscard]] virtual bool due(const Tick&) const noexcept { return true; }

  // Readings at the output shaft; NaN when the drive does not report it.
  [[nodiscard]] Rpm getRPM() const noexcept { return Rpm{static_cast<double>(feedback_.velocity_rpm)}; }
  [[nodiscard]] Amperes getCurrent() const noexcept {
    return Amperes{static_cast<double>(feedback_.current_a)};
  }
  [[nodiscard]] Degrees getAngle() const noexcept {
    return Degrees{static_cast<double>(feedback_.angle_deg)};
  }
  [[nodiscard]] Degrees getTotalAngle() const noexcept { return Degrees{feedback_.total_angle_deg}; }
  [[nodiscard]] const MotorFeedback& feedback() const noexcept { return feedback_; }
  [[nodiscard]] std::uint32_t limits() const noexcept { return limits_; }

  /// Rotor turns per turn of the output shaft.
  [[nodiscard]] virtual double get_GearRatio() const noexcept = 0;
  [[nodiscard]] virtual std::string_view modelName() const noexcept = 0;
  [[nodiscard]] virtual ModeSet modes() const noexcept = 0;
  [[nodiscard]] virtual const DriveFrames& driveFrames() const noexcept = 0;
  /// The drive's own spacing of feedback frames: the basis of "stale".
  [[nodiscard]] virtual Duration feedbackPeriod() const noexcept = 0;
  /// Whether this drive sends feedback without being asked.
  [[nodiscard]] virtual bool speaksUnasked() const noexcept = 0;

  /// Result of update(), for packers and for the state.
  [[nodiscard]] float commandValue() const noexcept { return command_value_; }
  [[nodiscard]] CommandUnit commandUnit() const noexcept { return command_unit_; }

  /// Progress of the sequence begun by order(kEnable) or order(kDisable). Drives without one are done
  /// at once.
  [[nodiscard]] virtual SequenceProgress sequenceProgress() const noexcept { return SequenceProgress::kDone; }

  /// Fault that the drive reported in its last frames; also that it left its enabled state while it was to
  /// obey. Drives that report nothing never complain.
  [[nodiscard]] virtual DriveComplaint complaint() const noexcept { return {}; }
  /// Begins to clear the drive's faults: the frames leave with the next packCommand() calls, and never move
  /// the motor.
  virtual void clearComplaint() noexcept {}

  /// Writer of settings to its drive; null: there are none to write. The settings: MotorTraits::setup.
  [[nodiscard]] virtual DriveConfiguring* driveConfiguring() noexcept { return nullptr; }

  /// The loops that rc10d closes for it, with the gains in force; null: its drive closes all of them.
  [[nodiscard]] virtual const CascadeConfig* hostLoops() const noexcept { return nullptr; }
  /// Other gains for hostLoops() from the next update() on, without a bump.
  virtual void retune(const CascadeConfig&) noexcept {}

  /// Makes the present position `angle_deg`. False while the position is unknown.
  virtual bool setZero(double angle_deg) noexcept = 0;
  /// The key `zero_deg` with which the shaft would read after a restart as it reads now, [-180, 180] deg.
  /// NaN: its encoder is not absolute, or nothing was heard yet.
  [[nodiscard]] virtual double zeroForFile() const noexcept {
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// Total angle that the last frame of the order kHold held; NaN: none.
  [[nodiscard]] virtual double heldAngleDeg() const noexcept {
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// Duty that the drive reports, of the output's direction; NaN: it reports none.
  [[nodiscard]] virtual float reportedDuty() const noexcept {
    return std::numeric_limits<float>::quiet_NaN();
  }
  /// The angle goes on without a known reference: homing is about to find it.
  virtual void forgetReference() noexcept { feedback_.zeroed = false; }

 protected:
  [[nodiscard]] float derating() const noexcept { return derating_; }
  [[nodiscard]] const OutputRange& speedBounds() const noexcept { return speeds_rpm_; }
  /// Target for update() while kCommand is ordered.
  [[nodiscard]] const Target& targetInForce() const noexcept { return in_force_ ? *in_force_ : target_; }
  /// Target for update() while kHold is ordered.
  [[nodiscard]] Target holdInForce(double held_deg) const noexcept {
    return {.mode = ControlMode::kTotalAngle,
            .value = std::isnan(led_place_deg_) ? held_deg : led_place_deg_};
  }

  MotorFeedback feedback_;
  std::uint32_t limits_ = 0;
  float command_value_ = 0.0F;  ///< Result of update().
  CommandUnit command_unit_ = CommandUnit::kNone;

 private:
  std::string name_;
  Target target_;
  std::optional<Target> in_force_;
  FrameKind ordered_ = FrameKind::kRest;
  float derating_ = 1.0F;
  double led_place_deg_ = std::numeric_limits<double>::quiet_NaN();  ///< orderHold(); NaN: none.
  OutputRange speeds_rpm_;
};

/// "motor 'lift' (M3508 id 1)"
[[nodiscard]] std::string describe(const Motor_Base& motor, int drive_id);

}  // namespace rc10
