#pragma once

#include <cstdint>
#include <memory>

#include "drives/odrive/odrive_frames.hpp"
#include "drives/odrive/odrive_model.hpp"
#include "sim/servo_drive.hpp"
#include "sim/sim_config.hpp"

namespace rc10::sim {

/// An ODrive axis: takes and sends the CANSimple frames of its firmware's generation.
class OdriveDrive : public ServoDrive {
 public:
  /// `settings` has passed its family's check().
  OdriveDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return feedback_period_; }
  [[nodiscard]] std::size_t feedback(std::span<CanFrame> out) noexcept override;
  void restart() noexcept override;
  void fault(std::uint32_t native_code) noexcept override;

  /// enable_watchdog and watchdog_timeout, as somebody sets them over USB; 0: off, as delivered.
  void setWatchdog(Duration timeout) noexcept;
  [[nodiscard]] odrive::AxisState state() const noexcept { return state_; }

 private:
  void requestState(std::uint32_t state) noexcept;
  void disarm(std::uint32_t errors) noexcept;
  void drive() noexcept;
  [[nodiscard]] bool starting() const noexcept { return elapsed() < ready_at_; }
  void answerQuestion(odrive::Message asked) noexcept;
  [[nodiscard]] CanFrame heartbeat() const noexcept;
  [[nodiscard]] CanFrame estimates() const noexcept;
  [[nodiscard]] CanFrame busVoltage() const noexcept;
  [[nodiscard]] CanFrame temperatures() const noexcept;
  [[nodiscard]] CanFrame torques() const noexcept;
  [[nodiscard]] double torqueLimitNm() const noexcept;

  int node_;
  OdriveFirmware firmware_;
  Duration feedback_period_;
  Duration telemetry_period_;
  double torque_constant_nm_per_a_;

  odrive::AxisState state_ = odrive::AxisState::kIdle;
  std::uint32_t errors_ = 0;
  odrive::ControlMode control_mode_ = odrive::ControlMode::kPosition;  // as delivered
  double input_turns_ = 0.0;
  double input_turns_per_s_ = 0.0;
  double input_torque_nm_ = 0.0;
  double velocity_limit_turns_per_s_ = 2.0;
  double current_limit_a_ = 10.0;
  Duration watchdog_{};
  Duration fed_at_{};
  Duration silent_until_{};
  Duration ready_at_{};
  Duration next_heartbeat_{};
  Duration next_telemetry_{};
};

[[nodiscard]] std::unique_ptr<Drive> makeOdriveDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
