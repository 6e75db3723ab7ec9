#pragma once

#include <array>
#include <string>
#include <vector>

#include "motor/motor_settings.hpp"
#include "motor/motor_traits.hpp"
#include "sim/drive.hpp"

namespace rc10::sim {

/// Physical parameters of a model's motor with this gear and load, from its traits. Missing ones are
/// estimated.
[[nodiscard]] MotorParameters servoParameters(const MotorTraits& traits, double gear_ratio,
                                              const MotorLoad& load) noexcept;

/// A drive with loops of its own: what most simulated families have in common. A family decodes its
/// commands into the modes below and encodes what drive...() tells. Angles, speeds and torques are at the
/// drive's own output, as it reports them itself: `gear_ratio` over the model's own lies behind it.
class ServoDrive : public Drive {
 public:
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::span<const FrameFilter> sends() const noexcept override { return sends_; }
  void step(Duration dt) noexcept override;
  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return Duration::zero(); }
  [[nodiscard]] std::size_t feedback(std::span<CanFrame> /*out*/) noexcept override { return 0; }
  [[nodiscard]] std::size_t answers(std::span<CanFrame> out) noexcept override;
  [[nodiscard]] MotorPhysics& physics() noexcept override { return physics_; }
  [[nodiscard]] const MotorPhysics& physics() const noexcept override { return physics_; }
  [[nodiscard]] const MotorLoad& load() const noexcept override { return load_; }
  void setLoad(const MotorLoad& load) noexcept override;
  /// Takes `reversed` alone, while the angle is 0.
  void setEncoderFault(const EncoderFault& fault) noexcept override {
    encoder_sign_ = fault.reversed ? -1.0 : 1.0;
  }

 protected:
  ServoDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load,
             std::vector<FrameFilter> sends);

  // The modes: each holds until the next.
  void release() noexcept { mode_ = Mode::kReleased; }
  void current(double rotor_a) noexcept;
  void voltage(double volts) noexcept;
  void torque(double nm) noexcept;
  /// With a feed-forward, and a bound of the torque (0: the motor's own).
  void velocity(double rpm, double torque_ff_nm = 0.0, double torque_limit_nm = 0.0) noexcept;
  /// A multi-turn angle at the drive's output, at no more than this speed (0: the motor's own).
  void position(double deg, double limit_rpm = 0.0, double torque_limit_nm = 0.0) noexcept;
  void impedance(double deg, double rpm, double stiffness_nm_per_rad, double damping_nms_per_rad,
                 double torque_ff_nm) noexcept;
  void shortWinding() noexcept;
  [[nodiscard]] bool released() const noexcept { return mode_ == Mode::kReleased; }

  // Measurements of the drive.
  [[nodiscard]] double driveAngleDeg() const noexcept;  ///< Multi-turn.
  [[nodiscard]] double driveRpm() const noexcept;
  [[nodiscard]] double driveTorqueNm() const noexcept;
  [[nodiscard]] double rotorRpm() const noexcept { return encoder_sign_ * physics_.measuredRotorRpm(); }
  [[nodiscard]] double currentA() const noexcept { return physics_.currentA(); }
  [[nodiscard]] const MotorTraits& traits() const noexcept { return traits_; }
  /// The present angle reads this from now on, as the drive's own zero command does.
  void zeroAt(double deg) noexcept;

  /// The time since construction, for watchdogs.
  [[nodiscard]] Duration elapsed() const noexcept { return elapsed_; }
  /// To be part of the next answers(); what is too much is lost.
  void answer(const CanFrame& frame) noexcept;
  /// It writes its flash for 50 ms, hears nothing meanwhile, and answers afterwards.
  void store() noexcept { stored_at_ = elapsed_ + std::chrono::milliseconds{50}; }
  [[nodiscard]] bool stores() const noexcept { return elapsed_ < stored_at_; }

 private:
  enum class Mode : std::uint8_t { kReleased, kCurrent, kVoltage, kTorque, kVelocity, kPosition, kImpedance };
  [[nodiscard]] WindingCommand winding(double dt_s) noexcept;
  [[nodiscard]] double velocityLoop(double wanted_rpm, double dt_s) noexcept;
  void enter(Mode mode) noexcept;

  std::string name_;
  MotorTraits traits_;
  double gear_ratio_;
  double drive_per_output_;  ///< Turns of the drive's output per turn of the shaft.
  MotorLoad load_;
  std::vector<FrameFilter> sends_;
  MotorPhysics physics_;
  Duration elapsed_{};
  Duration stored_at_{};
  Mode mode_ = Mode::kReleased;
  double value_ = 0.0;
  double value_rpm_ = 0.0;
  double stiffness_ = 0.0;
  double damping_ = 0.0;
  double torque_ff_nm_ = 0.0;
  double torque_limit_nm_ = 0.0;
  double integral_nm_ = 0.0;
  double zero_deg_ = 0.0;
  double encoder_sign_ = 1.0;
  std::array<CanFrame, kMaxFrames> answers_{};
  std::size_t answer_count_ = 0;
};

}  // namespace rc10::sim
