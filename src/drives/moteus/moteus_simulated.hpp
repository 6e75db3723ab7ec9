#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "drives/moteus/moteus_frames.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// One moteus controller and its motor. The modes that rc10d never commands are told apart; of those that
/// set phase voltages without looking at the rotor (5 to 7) no more is simulated than that they hold it. Not
/// simulated: position bounds, the integral gain (0 from the factory), registers of encoders and pins.
class MoteusDrive final : public ServoDrive {
 public:
  MoteusDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  void restart() noexcept override;
  void fault(std::uint32_t native_code) noexcept override;

  [[nodiscard]] moteus::Mode mode() const noexcept { return mode_; }
  /// Register 0x00C as the attached encoder sets it: 0 nothing is known, 1 the rotor, 2 the output.
  void setHomeState(int state) noexcept { home_state_ = state; }
  void setRegisterMapVersion(int version) noexcept { version_ = version; }

 private:
  /// The command registers; each mode write sets all of them back to this.
  struct Command {
    moteus::Mode mode = moteus::Mode::kStopped;
    double position_rev = 0.0;  // NaN: where it is
    double velocity_rev_s = 0.0;
    double torque_nm = 0.0;
    double kp_scale = 1.0;
    double kd_scale = 1.0;
    double ilimit_scale = 1.0;
    double max_torque_nm = 100.0;  // NaN: unbounded
    double stop_rev = std::numeric_limits<double>::quiet_NaN();
    double timeout_s = 0.0;                                         // 0: the configured one; NaN: none
    double limit_rev_s = std::numeric_limits<double>::quiet_NaN();  // NaN: the configured one; below 0: none
    double limit_rev_s2 = std::numeric_limits<double>::quiet_NaN();
    double fixed_v = std::numeric_limits<double>::quiet_NaN();
    double fixed_a = std::numeric_limits<double>::quiet_NaN();
    double ignore_bounds = 0.0;
    double lower_rev = 0.0;  // of stay-within; NaN: no bound
    double upper_rev = 0.0;
    std::array<double, 3> pwm{};
    std::array<double, 3> phase_v{};
    double foc_theta = 0.0;
    double foc_v = 0.0;
    double foc_theta_rate = 0.0;
    double d_v = 0.0;
    double q_v = 0.0;
    double d_a = 0.0;
    double q_a = 0.0;

    [[nodiscard]] bool atOnce() const noexcept { return limit_rev_s < 0.0 && limit_rev_s2 < 0.0; }
  };

  [[nodiscard]] bool meant(const CanFrame& frame) const noexcept;
  /// Code of the error; 0: written.
  [[nodiscard]] std::uint8_t write(const moteus::Item& item, bool& commanded) noexcept;
  /// Nothing: there is no such register, or not of this type.
  [[nodiscard]] std::optional<double> read(moteus::Register reg, moteus::Type type) noexcept;
  /// Value of a command register; null: there is no such.
  [[nodiscard]] double* commandOf(moteus::Register reg) noexcept;
  void obey() noexcept;
  void change(moteus::Mode mode) noexcept;
  void control(double dt_s) noexcept;
  void positionControl(double dt_s) noexcept;
  void stayWithin() noexcept;
  void push(double wanted_nm) noexcept;
  void profile(double goal_rev, double dt_s) noexcept;
  void damp(double kd_scale, double max_torque_nm) noexcept;
  [[nodiscard]] double kd() const noexcept;
  [[nodiscard]] double kp() const noexcept;
  [[nodiscard]] bool arrived() const noexcept;
  [[nodiscard]] double milliseconds(moteus::Type type) const noexcept;
  [[nodiscard]] double positionRev() const noexcept;

  std::uint32_t id_;
  std::uint32_t prefix_;
  Command command_;
  moteus::Mode mode_ = moteus::Mode::kStopped;
  std::uint32_t fault_ = 0;
  int home_state_ = 1;
  int version_ = 5;
  Duration clock_{};
  Duration switching_{};                                          ///< Time on its way from stopped to a mode.
  double left_s_ = 0.0;                                           ///< Until its watchdog; NaN: none.
  double course_rev_ = std::numeric_limits<double>::quiet_NaN();  ///< Where its controller holds the shaft.
  double course_rev_s_ = 0.0;
};

[[nodiscard]] std::unique_ptr<Drive> makeMoteusDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
