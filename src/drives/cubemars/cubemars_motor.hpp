#pragma once

#include <cstdint>

#include "drives/cubemars/cubemars_frames.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {

/// Common part of both kinds of AK drive: restarts and errors. Scheduler thread only.
///
/// No frame tells that a drive was restarted. A silence that is long enough to start up in is taken for
/// one: the position may then mean something else, and a drive that was to obey has stopped.
class CubeMars_Motor : public SoloMotor {
 public:
  [[nodiscard]] DriveComplaint complaint() const noexcept override;

 protected:
  CubeMars_Motor(const MotorSettings& settings, const CubemarsSettings& own);

  [[nodiscard]] const CubemarsSettings& own() const noexcept { return own_; }
  [[nodiscard]] int driveId() const noexcept { return id_; }
  /// The feedback of a drive with this id; whether it is whole is for updateFeedback() to see. A simulated
  /// drive on a virtual bus is on this computer too.
  [[nodiscard]] static bool isFrom(const CanFrame& frame, CanId id) noexcept {
    return frame.id == id && frame.type != FrameType::kError;
  }

  /// Forgets the reference and notes the stop if the drive must have been restarted since the last sample.
  /// True: it must.
  bool noticeRestart(MonotonicTime received) noexcept;
  /// The drive can have turned to this position (deg of its own output) since the last sample.
  [[nodiscard]] bool reaches(MonotonicTime received, double drive_deg) const noexcept;
  /// Accepts a position (deg of the drive's own output) unless the drive cannot have turned so far:
  /// then it is a jump as well.
  void takePosition(MonotonicTime received, double drive_deg) noexcept;
  /// The position that was accepted last.
  [[nodiscard]] double lastDriveDeg() const noexcept { return last_drive_deg_; }
  /// The servo protocol's feedback, which V3 drives send in MIT mode too.
  [[nodiscard]] FrameVerdict takeServoReport(const CanFrame& frame) noexcept;
  /// The last servo report was at the end of its position field.
  [[nodiscard]] bool positionCutOff() const noexcept { return position_cut_off_; }
  /// More than this without feedback, and the drive may have been restarted in between.
  [[nodiscard]] Duration longestGap() const noexcept { return longest_gap_; }
  void takeError(std::uint8_t error) noexcept { error_ = error; }
  [[nodiscard]] std::uint8_t error() const noexcept { return error_; }
  void forgetStop() noexcept { stopped_ = false; }

 private:
  CubemarsSettings own_;
  int id_;
  Duration longest_gap_;
  double reach_deg_per_s_;  ///< No position changes faster.
  double last_drive_deg_ = 0.0;
  std::uint8_t error_ = 0;
  bool position_cut_off_ = false;
  bool stopped_ = false;
};

}  // namespace rc10
