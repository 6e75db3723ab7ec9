#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rc10 {

/// Everything in which one RobStride or CyberGear model differs from another. At the drive's own output.
struct RobstrideModel {
  std::string_view name;
  // Ends of the scales of operation control and feedback.
  double position_range_rad = 0.0;
  double velocity_range_rad_s = 0.0;
  double torque_range_nm = 0.0;
  double stiffness_range_nm_per_rad = 0.0;
  double damping_range_nms_per_rad = 0.0;
  double max_current_a = 0.0;       ///< Peak value of the phase current.
  double torque_nm_per_arms = 0.0;  ///< At the output.
  double gear_ratio = 1.0;          ///< Its own.
  float no_load_rpm = 0.0F;         ///< At nominal_v.
  float nominal_v = 48.0F;
  float phase_resistance_ohm = 0.0F;   ///< 0: unknown.
  bool absolute = true;                ///< Knows its output's angle within a turn at power-up.
  std::uint16_t watchdog_index = 0;    ///< Parameter with the CAN timeout.
  std::uint8_t position_run_mode = 0;  ///< Value of run_mode that follows position references.
  bool cyber_gear = false;             ///< Numbers some faults differently.

  /// Torque for an ampere of the phase current's peak value, in which the drives count.
  [[nodiscard]] double torqueNmPerA() const noexcept;
};

/// nullptr if there is no such model.
[[nodiscard]] const RobstrideModel* findRobstrideModel(std::string_view name) noexcept;

[[nodiscard]] std::span<const RobstrideModel> robstrideModels() noexcept;
[[nodiscard]] std::span<const std::string_view> robstrideModelNames() noexcept;

}  // namespace rc10
