#pragma once

#include <string>

#include "drives/odrive/odrive_family.hpp"
#include "drives/odrive/odrive_motor.hpp"

namespace rc10::test {

/// An ODrive as a careful user configures it: 0.05 N·m/A, 20 A, 1500 rpm, everything reported a hundred times
/// a second.
[[nodiscard]] inline MotorSettings odriveSettings(const std::string& model = "ODrive_S1", int node = 3) {
  MotorSettings settings;
  settings.name = "wheel";
  settings.model = model;
  settings.id = node;
  settings.gear_ratio = 1.0;
  settings.effort_limit = 20.0F;
  settings.velocity_limit_rpm = 1500.0F;
  settings.feedback_hz = 1000;
  settings.own.set("torque_constant_nm_per_a", 0.05);
  settings.own.set("telemetry_hz", 100.0);
  settings.own.set("iq_reversed", 0.0);
  return settings;
}

[[nodiscard]] inline std::unique_ptr<ODrive_Motor> odriveMotor(const MotorSettings& settings) {
  return std::make_unique<ODrive_Motor>(settings, odriveFamily().traits(settings.model, settings.own));
}

}  // namespace rc10::test
