#pragma once

#include <array>

#include "motor/motor_family.hpp"
#include "motor/solo_motor.hpp"

namespace acme {

/// A motor with an ACME Turner drive, the invented protocol of docs/adding-a-motor.md. Scheduler thread only.
///
/// Commands, standard id 0x300 + id, 8 bytes, little-endian: mode (0 off, 1 current, 2 velocity, 3 clear the
/// fault), one byte unused, int16 current in mA, int16 velocity in 0.1 rpm of the rotor, two bytes unused.
/// Feedback, standard id 0x380 + id, 8 bytes, 200 times a second: int32 rotor angle in 0.01 deg, going on
/// over turns; int16 rotor velocity in 0.1 rpm; uint8 temperature in C; flags: bit 0 enabled, bits 1-2 fault.
class ACME_Motor : public rc10::SoloMotor {
 public:
  ACME_Motor(const rc10::MotorSettings& settings, const rc10::MotorTraits& traits);

  // The receiving half.
  [[nodiscard]] std::span<const rc10::FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const rc10::CanFrame& frame) const noexcept override;
  rc10::FrameVerdict updateFeedback(const rc10::CanFrame& frame) noexcept override;

  // Order and target to command.
  void update(const rc10::Tick& tick) noexcept override;
  [[nodiscard]] rc10::SequenceProgress sequenceProgress() const noexcept override;
  [[nodiscard]] rc10::DriveComplaint complaint() const noexcept override;
  void clearComplaint() noexcept override { clear_ = true; }

  // The sending half.
  [[nodiscard]] std::span<const rc10::CanId> commandIds() const noexcept override { return command_ids_; }
  [[nodiscard]] std::size_t packCommand(const rc10::Tick& tick,
                                        std::span<rc10::CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<rc10::CanFrame> out) const noexcept override;

 protected:
  /// Current for the next frame, within the limit; A at the motor.
  void obeyCurrent(double current_a) noexcept;

 private:
  void obeyVelocity(double output_rpm) noexcept;

  enum class Mode : std::uint8_t { kOff = 0, kCurrent = 1, kVelocity = 2, kClear = 3 };

  [[nodiscard]] rc10::CanFrame frame(Mode mode, double current_a, double velocity_rpm) const noexcept;

  std::array<rc10::FrameFilter, 1> filters_;
  std::array<rc10::CanId, 1> command_ids_;
  Mode mode_ = Mode::kOff;
  double current_a_ = 0.0;
  double velocity_rpm_ = 0.0;  ///< Velocity of the rotor.
  std::uint8_t flags_ = 0;     ///< Flags of the last feedback.
  bool clear_ = false;         ///< The next frame clears the fault.
};

/// The family: the "Turner" with loops of its own, the "Turner-C" with those of the host.
[[nodiscard]] const rc10::MotorFamily& acmeFamily() noexcept;

}  // namespace acme
