#pragma once

#include <cstdint>

#include "fuzz_input.hpp"
#include "motor/motor_base.hpp"

namespace rc10::fuzz {

inline Target takeTarget(Input& input) {
  Target target;
  target.mode = static_cast<ControlMode>(input.take<std::uint8_t>() % kControlModeCount);
  target.value = input.take<double>();
  target.velocity_ff_rpm = input.take<float>();
  target.torque_ff_nm = input.take<float>();
  target.stiffness_nm_per_rad = input.take<float>();
  target.damping_nms_per_rad = input.take<float>();
  return target;
}

/// One of the things that the daemon does to a motor, by `which` modulo `choices`. False: none of them, the
/// rest of the choices is the caller's.
inline bool giveOrder(Motor_Base& motor, Input& input, unsigned which, unsigned choices = 8) {
  switch (which % choices) {
    case 0: motor.order(static_cast<FrameKind>(input.take<std::uint8_t>() % 9U)); return true;
    case 1: (void)motor.setTarget(takeTarget(input)); return true;
    case 2: motor.order(FrameKind::kCommand, takeTarget(input)); return true;
    case 3: (void)motor.setZero(input.take<double>()); return true;
    case 4: motor.derate(input.take<float>()); return true;
    case 5: motor.clearComplaint(); return true;
    default: return false;
  }
}

}  // namespace rc10::fuzz
