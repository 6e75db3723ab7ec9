#pragma once

#include "drives/moteus/moteus_model.hpp"

namespace rc10::test {

/// A direct drive with all keys at their defaults, and the motor of the vendor's kit.
[[nodiscard]] inline MotorSettings moteusMotor(int id = 1) {
  MotorSettings settings;
  settings.name = "arm";
  settings.model = "moteus";
  settings.id = id;
  settings.effort_limit = 20.0F;
  settings.feedback_hz = 1000;
  settings.own.set("motor_kv_rpm_per_v", 304.0);
  settings.own.set("rotor_to_output_ratio", 1.0);
  settings.own.set("watchdog_ms", 100.0);
  settings.own.set("can_prefix", 0.0);
  settings.own.set("bit_rate_switch", 1.0);
  settings.own.set("absolute", 0.0);
  return settings;
}

}  // namespace rc10::test
