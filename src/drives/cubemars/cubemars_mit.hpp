#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drives/cubemars/cubemars_motor.hpp"
#include "drives/cubemars/sent_laws.hpp"
#include "motor/enable_sequence.hpp"
#include "motor/lead_bound.hpp"
#include "motor/position_reach.hpp"
#include "motor/saturated_speed.hpp"
#include "motor/wrapped_speed.hpp"

namespace rc10 {

/// An AK drive in MIT mode: torque = stiffness * (position error) + damping * (velocity error) + torque, all
/// in the drive. V1 and V2 obey after they were told to enter that mode and answer each frame; V3 obey
/// always and speak unasked.
///
/// The last law may stay in a drive that leaves the mode, and act again when it enters; outside of it a drive
/// ignores laws. So "no torque" goes before leaving, until both are answered, and behind entering.
///
/// effortLimit() bounds the sum that the drive will make of a command, as far as the last feedback tells;
/// without feedback for longestGap() nothing but "no torque" is sent. Scheduler thread only.
class CubemarsMit : public CubeMars_Motor {
 public:
  /// `settings` has passed its family's check().
  CubemarsMit(const MotorSettings& settings, const CubemarsSettings& own);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override;
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;
  [[nodiscard]] SequenceProgress sequenceProgress() const noexcept override;
  /// V1 and V2: enters the mode without torque and leaves it again, which is what clears their errors.
  void clearComplaint() noexcept override;
  [[nodiscard]] DriveComplaint complaint() const noexcept override;

  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override;
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;
  bool setZero(double angle_deg) noexcept override;
  void dropWindup(float least_rpm) noexcept override;

 private:
  enum class Step : std::uint8_t { kEnter };

  [[nodiscard]] FrameVerdict takeMitReport(const CanFrame& frame) noexcept;
  [[nodiscard]] double unwrapped(double position_rad, bool anew) noexcept;
  void runEnabling(const Tick& tick) noexcept;
  [[nodiscard]] bool silent(const Tick& tick) const noexcept;
  [[nodiscard]] bool inRange() const noexcept { return turns_ == 0 && !turns_unknown_ && !positionCutOff(); }
  /// Bound of targets, as a position of the drive, with this stiffness at its output.
  [[nodiscard]] double springReach(double stiffness_nm_per_rad) const noexcept;
  void watchSpring(const cubemars::MitReport& report, MonotonicTime received) noexcept;
  [[nodiscard]] bool pullsOtherwise() const noexcept;
  [[nodiscard]] bool limited() const noexcept;
  /// A turn of the field that is not known makes every angle wrong, but a wheel without limits may count
  /// anew.
  [[nodiscard]] bool refusesZeros() const noexcept { return turns_unknown_ && limited(); }
  [[nodiscard]] SpringLaw lawOf(const Target& target, MonotonicTime now) noexcept;
  [[nodiscard]] SpringLaw velocityLaw(double output_rpm, double torque_ff_nm, double gain) noexcept;
  [[nodiscard]] SpringLaw angleLaw(const Target& target, double stiffness, double damping) noexcept;
  /// The same for an angle to go to, no faster than the limit.
  [[nodiscard]] SpringLaw approachLaw(const Target& target, MonotonicTime now) noexcept;
  void send(const SpringLaw& wanted_law) noexcept;
  void release() noexcept;
  [[nodiscard]] std::size_t packEnter(std::span<CanFrame> out) noexcept;
  /// The law in the drive is "no torque", and it has left the mode.
  [[nodiscard]] bool leftAtRest() noexcept;
  [[nodiscard]] double boundRpm(double wanted_rpm) noexcept;
  [[nodiscard]] double driveRadS(double output_rpm) const noexcept;
  [[nodiscard]] double limitRadS() const noexcept;  ///< 0: none.
  /// By the last feedback; where the field of the speed is cut off, by the way.
  [[nodiscard]] SpringState measured() const noexcept;
  [[nodiscard]] CanFrame commandFrame(const SpringLaw& law) const noexcept;

  bool v3_;
  std::array<FrameFilter, 2> filters_;
  std::array<CanId, 2> command_ids_;
  double angle_stiffness_;
  double angle_damping_;
  double velocity_gain_;

  // The last feedback, in the drive's own terms.
  double position_rad_ = 0.0;
  double velocity_rad_s_ = 0.0;
  WrappedSpeed speed_;
  SaturatedSpeed cut_off_speed_;
  int samples_at_speed_end_ = 0;
  int turns_ = 0;               ///< Wraps of the position field; 0: within its range.
  bool turns_unknown_ = false;  ///< Silent while outside of its range, and maybe restarted.
  int samples_at_end_ = 0;
  Travel travel_;
  SpringReach reach_;
  LeadBound lead_;

  SpringLaw command_{};  ///< Result of update().
  SentLaws sent_;
  int samples_against_ = 0;  ///< In a row, of a spring that pulls the other way; signed by its torque.
  EnableSequence<Step> enabling_;
  bool enter_now_ = false;
  bool clear_now_ = false;
  bool entered_ = false;  ///< The last frames were those that enter the mode.
  /// Count of answers when it was first told to leave the mode.
  std::optional<std::uint64_t> samples_before_rest_;
  std::uint64_t samples_before_ = 0;  ///< Count when it was first told to enter the mode.
};

}  // namespace rc10
