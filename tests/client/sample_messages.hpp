#pragma once

#include <limits>

#include "link/link_protocol.hpp"

namespace rc10::test {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The two motors of heroWelcome(): one turns under a command, the other has a fault.
inline link::State heroState() {
  link::State state;
  state.utime = 1'700'000'000'000'000;
  state.mono_us = 42'000'000;
  state.tick = 41'000;
  state.realtime = 1;
  state.stopped_mono_us = 41'000'000;
  state.estop_count = 3;
  state.motor_count = 2;
  auto& wheel = state.motors[0];
  wheel.status = MotorStatus::kActive;
  wheel.mode = ControlMode::kVelocity;
  wheel.command_unit = CommandUnit::kAmpere;
  wheel.zeroed = 0;
  wheel.limits = 1;
  wheel.feedback_age_us = 420;
  wheel.feedback_age_at_use_us = 460;
  wheel.command_age_us = 5200;
  wheel.acting = Acting::kTarget;
  wheel.target = 120.0;
  wheel.target_shaped = 119.0;
  wheel.total_angle_deg = 7321.5;
  wheel.angle_deg = 121.5F;
  wheel.velocity_rpm = 118.26F;
  wheel.current_a = 0.42F;
  wheel.torque_nm = 0.126F;
  wheel.voltage_v = kNaN;
  wheel.temperature_c = 31.0F;
  wheel.command_value = 0.43F;
  wheel.feedback_hz = 999.5F;
  wheel.owner = "teleop";
  auto& yaw = state.motors[1];
  yaw.status = MotorStatus::kFault;
  yaw.fault = 12;
  yaw.stop_cause = StopCause::kFault;
  yaw.zeroed = 1;
  yaw.feedback_age_us = -1;
  yaw.total_angle_deg = std::numeric_limits<double>::quiet_NaN();
  yaw.angle_deg = yaw.velocity_rpm = yaw.current_a = yaw.torque_nm = yaw.voltage_v = yaw.temperature_c = kNaN;
  return state;
}

inline link::Diagnostics heroDiagnostics() {
  link::Diagnostics diagnostics;
  diagnostics.utime = 1'700'000'000'000'001;
  diagnostics.mono_us = 42'000'001;
  diagnostics.tick = 41'001;
  diagnostics.tick_period_us = 1000;
  diagnostics.wake_latency = {4.1F, 38.5F, 61.0F, 180.2F};
  diagnostics.tick_duration = {12.0F, 19.5F, 25.0F, 70.0F};
  diagnostics.missed_ticks = 2;
  diagnostics.page_faults = 0;
  diagnostics.events_dropped = 1;
  diagnostics.refusal_count = 2;
  diagnostics.refusals[0].name = "expired";
  diagnostics.refusals[0].count = 3;
  diagnostics.refusals[1].name = "unknown motor";
  diagnostics.counter_count = 1;
  diagnostics.counters[0].name = "e-stops";
  diagnostics.counters[0].count = 4;
  diagnostics.duration_count = 2;
  diagnostics.durations[0].name = "command to frames";
  diagnostics.durations[0].count = 41'000;
  diagnostics.durations[0].percentiles = {420.0F, 900.0F, 950.0F, 1020.5F};
  diagnostics.durations[1].name = "feedback at use: yaw";
  diagnostics.notice_count = 1;
  diagnostics.notices[0] = "not real-time: no permission";
  diagnostics.bus_count = 1;
  auto& bus = diagnostics.buses[0];
  bus.name = "chassis";
  bus.interface = "can0";
  bus.state = BusState::kWarning;
  bus.tec = 96;
  bus.rec = -1;
  bus.predicted_load = 0.556F;
  bus.predicted_load_worst = 0.676F;
  bus.measured_load = 0.548F;
  bus.rx_frames = 164'000;
  bus.rx_unmatched = 5;
  bus.rx_malformed = 1;
  bus.rx_dropped = 2;
  bus.tx_frames = 41'000;
  bus.tx_confirmed = 40'990;
  bus.tx_dropped = 3;
  bus.tx_held = 8;
  bus.rx_foreign = 6;
  bus.error_frames = 7;
  bus.restarts = 4;
  return diagnostics;
}

}  // namespace rc10::test
