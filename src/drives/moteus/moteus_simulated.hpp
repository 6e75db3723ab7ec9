#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "drives/moteus/moteus_frames.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// One moteus controller and its motor. Not simulated: current mode and the other modes that rc10d never
/// commands, position bounds and the integral gain (0 from the factory).
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
    std::optional<double> max_torque_nm;
    double timeout_s = 0.0;    // 0: the configured one; NaN: none
    double limit_rev_s = 0.0;  // 0: not written; below: none
    double limit_rev_s2 = 0.0;

    [[nodiscard]] bool atOnce() const noexcept { return limit_rev_s < 0.0 && limit_rev_s2 < 0.0; }
  };

  [[nodiscard]] bool meant(const CanFrame& frame) const noexcept;
  void write(const moteus::Item& item, bool& commanded) noexcept;
  [[nodiscard]] double read(moteus::Register reg) const noexcept;
  void obey() noexcept;
  void change(moteus::Mode mode) noexcept;
  void control(double dt_s) noexcept;
  void positionControl(double dt_s) noexcept;
  void profile(double goal_rev, double dt_s) noexcept;
  void damp(double kd_scale, double max_torque_nm) noexcept;
  [[nodiscard]] double kd() const noexcept;
  [[nodiscard]] double positionRev() const noexcept;

  std::uint32_t id_;
  std::uint32_t prefix_;
  Command command_;
  moteus::Mode mode_ = moteus::Mode::kStopped;
  std::uint32_t fault_ = 0;
  int home_state_ = 1;
  int version_ = 5;
  Duration clock_{};
  Duration switching_{};  ///< How long it has been on its way from stopped to a mode.
  double left_s_ = 0.0;   ///< Until its watchdog; NaN: none.
  double course_rev_ = std::numeric_limits<double>::quiet_NaN();  ///< Where its controller holds the shaft.
  double course_rev_s_ = 0.0;
};

[[nodiscard]] std::unique_ptr<Drive> makeMoteusDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
