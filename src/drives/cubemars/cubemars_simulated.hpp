#pragma once

#include <memory>

#include "drives/cubemars/cubemars_frames.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// A CubeMars AK drive in the protocol that it is configured for. Its own decoder: nothing here uses what
/// the motor class packs with, except for ids and field ranges.
class CubemarsDrive : public ServoDrive {
 public:
  CubemarsDrive(const MotorSettings& settings, const CubemarsSettings& own, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  [[nodiscard]] Duration feedbackPeriod() const noexcept override;
  [[nodiscard]] std::size_t feedback(std::span<CanFrame> out) noexcept override;
  /// Silent and deaf for a while, then without a command; without an output encoder its position begins
  /// again within half a turn of the rotor.
  void restart() noexcept override;
  /// Servo and V3: ends by itself after 500 ms, as in the VESC firmware. MIT: until it enters the mode again.
  void fault(std::uint32_t native_code) noexcept override;

 private:
  void receiveServo(const CanFrame& frame) noexcept;
  void receiveMit(const CanFrame& frame) noexcept;
  void takeLaw(std::uint32_t position, std::uint32_t velocity, std::uint32_t stiffness, std::uint32_t damping,
               std::uint32_t torque) noexcept;
  void followLaw() noexcept;
  void setDrivePosition(double message_deg, double limit_rpm) noexcept;
  [[nodiscard]] CanFrame servoFeedback() const noexcept;
  [[nodiscard]] CanFrame mitReply() const noexcept;
  [[nodiscard]] bool off() const noexcept { return elapsed() < boots_until_; }
  [[nodiscard]] double rpmOf(double erpm) const noexcept;

  CubemarsSettings own_;
  int id_;
  Duration feedback_period_;
  bool entered_ = false;  ///< MIT: obeys.
  SpringLaw law_{};       ///< The last: kept over leaving the mode, and obeyed again on entering it.
  std::uint8_t error_ = 0;
  Duration error_until_{};
  Duration last_command_{};
  Duration boots_until_{};
};

[[nodiscard]] std::unique_ptr<Drive> makeCubemarsDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
