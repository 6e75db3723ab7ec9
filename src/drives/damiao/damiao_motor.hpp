#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drives/damiao/damiao_enabling.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "drives/damiao/damiao_frames.hpp"
#include "drives/damiao/damiao_mit.hpp"
#include "drives/damiao/damiao_position.hpp"
#include "drives/damiao/damiao_setup.hpp"
#include "motor/drive_configuring.hpp"
#include "motor/position_reach.hpp"
#include "motor/solo_motor.hpp"
#include "motor/wrapped_speed.hpp"

namespace rc10 {

/// A Damiao motor in one of its control modes. It sends nothing but answers, so at rest the disable
/// frame is repeated, and the drive answers with its state. Nothing but that, and the clearing of faults,
/// is sent to a drive that the enable sequence has not enabled: it would keep a target and act on it later.
/// Scheduler thread only.
class Damiao_Motor : public SoloMotor {
 public:
  /// `settings` has passed the family's check().
  explicit Damiao_Motor(const MotorSettings& settings);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;
  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;
  void clearComplaint() noexcept override;
  bool setZero(double angle_deg) noexcept override;
  void dropWindup(float least_rpm) noexcept override;
  [[nodiscard]] DriveConfiguring* driveConfiguring() noexcept override { return &configuring_; }

  /// The id of its control frames. The registers' id, which it also sends, is common to all Damiao drives:
  /// they tell by the payload which of them is meant.
  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  /// native_code of a complaint about a register: this and its address.
  static constexpr std::uint32_t kRegisterComplaint = 0x100;

 private:
  void takeState(const damiao::State& state, MonotonicTime received) noexcept;
  void takeReply(const damiao::RegisterReply& reply) noexcept;
  void runEnabling(const Tick& tick) noexcept;
  [[nodiscard]] bool asksPosition(const Tick& tick) noexcept;

  // Each writes command_.
  void release() noexcept;
  void followMit(const Target& target, MonotonicTime now) noexcept;
  void followVelocity(const Target& target) noexcept;
  void followAngle(const Target& target) noexcept;

  [[nodiscard]] SpringLaw mitLaw(const Target& target) const noexcept;
  /// Bound of targets, as a position of the drive, with this stiffness at its output.
  [[nodiscard]] double springReach(double stiffness_nm_per_rad) const noexcept;
  [[nodiscard]] bool reachesTravelAt(double angle_deg) const noexcept;
  [[nodiscard]] double torqueLimitNm() const noexcept;
  /// Bounds every velocity; the scale's if there is none.
  [[nodiscard]] double fastestRadS() const noexcept;
  [[nodiscard]] CanFrame frameOf(CanId id, std::span<const std::uint8_t> payload) const noexcept;
  [[nodiscard]] CanFrame specialFrame(damiao::Special command) const noexcept;

  DamiaoSettings own_;
  int id_;
  std::array<FrameFilter, 1> filters_;
  std::array<CanId, 1> command_ids_;
  double damp_nms_per_rad_;
  Duration heard_within_;  ///< A drive silent for longer is not asked for a register as well.

  DamiaoPosition position_;
  WrappedSpeed speed_;
  Travel travel_;
  SpringReach reach_;
  LeadBound lead_;
  DamiaoEnabling enabling_;
  DamiaoSetupCodec setup_codec_;
  DriveConfiguring configuring_{setup_codec_};
  CanFrame command_;
  double measured_rad_s_ = 0.0;  ///< Speed of the drive.
  std::uint8_t status_ = damiao::kStatusDisabled;
  bool armed_ = false;    ///< Enabled by the sequence, and neither rested nor stopped since.
  bool stopped_ = false;  ///< Not enabled, though it was to obey.
  int clears_left_ = 0;
  std::optional<double> stay_rad_;  ///< Place that a position mode keeps without a target.
  MonotonicTime asked_position_{};
};

}  // namespace rc10
