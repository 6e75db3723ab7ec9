#pragma once

#include <array>

#include "drives/cubemars/cubemars_motor.hpp"
#include "motor/first_angle.hpp"

namespace rc10 {

/// An AK drive in servo mode: its own loops, extended ids, feedback unasked at the rate set in the vendor's
/// program. It needs no enabling: any command drives it, a current of 0 lets go.
///
/// The drive's loops know only the drive's own limit of the current: effortLimit() bounds currents and the
/// brake, and an effort limit of 0 lets go in every mode. Scheduler thread only.
class CubemarsServo : public CubeMars_Motor {
 public:
  /// `settings` has passed its family's check().
  CubemarsServo(const MotorSettings& settings, const CubemarsSettings& own);

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override;
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override;
  void update(const Tick& tick) noexcept override;

  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

  /// Nothing clears a servo drive's error but the end of its cause. Forgets that it has stopped.
  void clearComplaint() noexcept override { forgetStop(); }
  bool setZero(double angle_deg) noexcept override;

 private:
  void follow(const Target& target) noexcept;
  void release() noexcept;
  void damp() noexcept;
  void followCurrent(const Target& target) noexcept;
  void brake() noexcept;
  void followVelocity(double wanted_rpm) noexcept;
  void followAngle(double total_angle_deg) noexcept;
  void followDuty(double duty) noexcept;
  [[nodiscard]] double erpmOf(double output_rpm) const noexcept;

  std::array<FrameFilter, 1> filters_;
  std::array<CanId, 6> command_ids_;
  double brake_a_;
  double acceleration_rpm_per_s_;
  Travel travel_;
  CanFrame next_;  ///< Result of update().
};

}  // namespace rc10
