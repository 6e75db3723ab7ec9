#pragma once

#include <array>
#include <cstdint>

#include "drives/robstride/robstride_enabling.hpp"
#include "drives/robstride/robstride_family.hpp"
#include "drives/robstride/robstride_frames.hpp"
#include "drives/robstride/robstride_model.hpp"
#include "drives/robstride/robstride_setup.hpp"
#include "motor/drive_configuring.hpp"
#include "motor/lead_bound.hpp"
#include "motor/position_reach.hpp"
#include "motor/saturated_speed.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// A RobStride RS00-RS06, EL05 or CyberGear on its private protocol. Scheduler thread only.
///
/// The drive answers every frame with its state, and says nothing unasked: not enabled, it is told to stop
/// again and again. Operation mode: the drive's own torque limit is not trusted alone; position and velocity
/// references are kept so close to the measured ones that the torque stays within the limit. Its position
/// scale ends after two turns to each side of the drive's zero. Beyond them angles are not followed, only
/// damped: how the drive compares a position on the scale with its own is not documented there.
class RobStride_Motor : public SoloMotor {
 public:
  /// `settings` has passed the family's check().
  explicit RobStride_Motor(const MotorSettings& settings);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;

  /// Reading and writing parameters. A command of the operation mode carries its torque in its id, so these
  /// cannot be listed; and of what is listed, the lowest is to be sent in every state, because its echo is
  /// watched: reading, so enable and stop are not listed either.
  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;
  void clearComplaint() noexcept override;
  bool setZero(double angle_deg) noexcept override;
  void dropWindup(float least_rpm) noexcept override;
  [[nodiscard]] DriveConfiguring* driveConfiguring() noexcept override { return &configuring_; }

  /// native_code of a complaint about a parameter: this and its index. Beyond the bits of a drive's faults.
  static constexpr std::uint32_t kParameterComplaint = 0x4000'0000;

 private:
  /// The reference of a run mode, as the drive takes it, and the current that it may use for it.
  struct Reference {
    float value = 0.0F;
    float current_limit_a = 0.0F;
  };

  [[nodiscard]] double limitNm() const noexcept;
  [[nodiscard]] double limitRadS() const noexcept;
  [[nodiscard]] double ratio() const noexcept;  ///< Turns of the drive's output per turn of the shaft.
  [[nodiscard]] bool wraps() const noexcept;
  [[nodiscard]] double scaleEndRad() const noexcept;  ///< As far as operation mode can be told to go.
  [[nodiscard]] bool positionOnScale() const noexcept;
  /// A place would be one of the drive's count, which nobody knows.
  [[nodiscard]] bool placeUnknown() const noexcept { return angles_in_doubt_ || feedback_.angle_at_end; }
  [[nodiscard]] double positionRadFor(double total_angle_deg) const noexcept;
  /// Total angle that a brake keeps in this tick, in deg.
  [[nodiscard]] double brakeDeg() noexcept;
  [[nodiscard]] SpringState measured() const noexcept {
    return {position_rad_ + scale_offset_rad_, speed_.of(seen_.velocity_rad_s)};
  }

  void takeFeedback(const robstride::Feedback& seen, MonotonicTime received) noexcept;
  void takeParameter(const CanFrame& frame) noexcept;
  void trackPosition(const robstride::Feedback& seen, MonotonicTime received) noexcept;
  void doubtAngles() noexcept;
  /// One would be followed nowhere until the drive is enabled anew, in another count perhaps.
  [[nodiscard]] bool refusesZeros() const noexcept { return angles_in_doubt_ && obeying(); }
  void takePosition(double rad) noexcept;

  void followOperation(const Target& target, MonotonicTime now) noexcept;
  void followCurrent(const Target& target) noexcept;
  void limitLoop(bool acts) noexcept;
  void followVelocity(const Target& target) noexcept;
  void followAngle(const Target& target) noexcept;
  [[nodiscard]] double clampVelocity(double rad_s) noexcept;
  void limitApproach(SpringLaw& wanted, MonotonicTime now) noexcept;
  void limitTorque(SpringLaw& wanted) noexcept;

  [[nodiscard]] std::size_t packReference(const Tick& tick, std::span<CanFrame> out) noexcept;

  const RobstrideModel* model_;
  robstride::Codec codec_;
  RobstrideControl control_;
  double angle_stiffness_;  ///< Stiffness at the drive's output, as all of these.
  double angle_damping_;
  double velocity_gain_;
  std::array<FrameFilter, 5> filters_;
  std::array<CanId, 2> command_ids_;
  RobstrideEnabling enabling_;
  RobstrideSetupCodec setup_codec_{codec_};
  DriveConfiguring configuring_{setup_codec_};

  robstride::Feedback seen_;
  SaturatedSpeed speed_;
  std::uint32_t fault_word_ = 0;
  double position_rad_ = 0.0;      ///< Position of the drive's output, over turns.
  double scale_offset_rad_ = 0.0;  ///< The drive's own count of turns is this much more.
  bool angles_in_doubt_ = false;   ///< Until the next enabling.
  bool clear_ordered_ = false;
  bool clear_sent_ = false;

  SpringLaw operation_;
  Reference reference_;
  Travel travel_;
  SpringReach reach_;
  LeadBound lead_;
  bool brake_held_ = false;
  double brake_rad_ = 0.0;  ///< Place of the brake by the count of the drive.
  float limit_sent_a_ = -1.0F;
  MonotonicTime limit_sent_at_{};
  int limit_repeats_ = 0;  ///< So many turns still send it.
  MonotonicTime read_at_{};
};

}  // namespace rc10
