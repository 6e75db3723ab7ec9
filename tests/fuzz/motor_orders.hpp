#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "fuzz_input.hpp"
#include "motor/solo_motor.hpp"

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

/// Orders and frames by `takeFrame(input)`, a tick after each; `checkTick()` and `checkSent(frame)` judge the
/// motor and its frames. Its readings are numbers, its angle within a turn.
template <typename TakeFrame, typename CheckTick, typename CheckSent>
void runAlone(SoloMotor& motor, Input& input, TakeFrame takeFrame, CheckTick checkTick, CheckSent checkSent) {
  MonotonicTime now{std::chrono::hours{1}};
  Tick tick;
  while (!input.empty()) {
    if (!giveOrder(motor, input, input.take<std::uint8_t>())) {
      CanFrame frame = takeFrame(input);
      frame.received = now += Duration{input.take<std::uint32_t>()};
      if (motor.matchesFrame(frame)) (void)motor.updateFeedback(frame);
    }
    ++tick.index;
    tick.now = now;
    motor.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor.packCommand(tick, out);
    for (std::size_t i = 0; i < count; ++i) checkSent(out[i]);
    checkTick();
    require(std::isfinite(motor.commandValue()) || std::isinf(motor.commandValue()));
    const MotorFeedback& feedback = motor.feedback();
    if (feedback.samples == 0) continue;
    require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
    require(std::isfinite(feedback.total_angle_deg));
  }
}

}  // namespace rc10::fuzz
