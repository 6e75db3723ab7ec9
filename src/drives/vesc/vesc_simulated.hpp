#pragma once

#include <cstdint>
#include <memory>

#include "drives/vesc/vesc_frames.hpp"
#include "drives/vesc/vesc_model.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// A simulated VESC with stock settings: it obeys any SET_* at once, stops a second after the last one, lets
/// its motor go below 900 ERPM, clears its faults after half a second. It reads frames as firmware 6.00 and
/// later do: a SET_CURRENT of 6 bytes or more is something else than one of 4.
class VescDrive : public ServoDrive {
 public:
  VescDrive(const MotorSettings& settings, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return period_; }
  [[nodiscard]] std::size_t feedback(std::span<CanFrame> out) noexcept override;
  /// Silent for as long as a drive takes to start; counts from 0 then.
  void restart() noexcept override;
  /// Obeys nothing for half a second, then goes on as if nothing had been.
  void fault(std::uint32_t native_code) noexcept override;
  /// 0 disables it, as the setting in VESC Tool does.
  void setWatchdog(Duration timeout) noexcept { watchdog_ = timeout; }
  [[nodiscard]] bool timedOut() const noexcept;

 private:
  void command(vesc::Packet packet, const CanFrame& frame) noexcept;
  void question(const CanFrame& frame) noexcept;
  /// Quantity that it regulates itself in each step, beyond ServoDrive's modes.
  enum class Loop : std::uint8_t { kNone, kBrake, kSpeed, kPlace };
  void stepLoop(Duration dt) noexcept;
  void stepSpeed(Duration dt) noexcept;
  [[nodiscard]] double dutyNow() const noexcept;
  [[nodiscard]] double encoderDeg() const noexcept;
  [[nodiscard]] std::int64_t stepsNow() const noexcept;
  [[nodiscard]] CanFrame status(vesc::Packet packet) const noexcept;

  VescSettings own_;
  int id_;
  Duration period_;
  Duration watchdog_{std::chrono::seconds{1}};
  Duration commanded_;  ///< When, as elapsed().
  Duration obeys_from_{};
  Duration speaks_from_{};
  Duration slow_next_{};
  bool booting_ = false;
  std::uint8_t fault_ = 0;
  double brake_a_ = 0.0;
  Loop loop_ = Loop::kNone;
  double speed_rpm_ = 0.0;    ///< Rotor; ramps to the command.
  double command_rpm_ = 0.0;  ///< Rotor.
  double place_deg_ = 0.0;    ///< A value of encoderDeg().
  double divided_zero_deg_ = 0.0;
  std::int64_t steps_zero_ = 0;
};

[[nodiscard]] std::unique_ptr<Drive> makeVescDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
