#pragma once

// Readings of a motor, one number each, at the output shaft. Each line is a field of link::MotorState and, by
// its name, of motor_state_t.lcm, a key of rc10ctl's JSON and a signal of its verbs. READING(type, name,
// initial); NaN: the drive does not report it.

/// Readings of MotorFeedback, by its names there.
#define RC10_FEEDBACK_READINGS(READING) \
  READING(double, total_angle_deg, 0.0) \
  READING(float, angle_deg, 0.0F)       \
  READING(float, velocity_rpm, 0.0F)    \
  READING(float, current_a, 0.0F)       \
  READING(float, torque_nm, 0.0F)       \
  READING(float, voltage_v, 0.0F)       \
  READING(float, temperature_c, 0.0F)

/// Readings of the tick, and of the daemon's other threads.
#define RC10_TICK_READINGS(READING)                 \
  READING(double, target, 0.0)                      \
  READING(double, target_shaped, 0.0)               \
  READING(float, command_value, 0.0F)               \
  READING(float, feedback_hz, 0.0F)                 \
  READING(std::int32_t, feedback_age_us, -1)        \
  READING(std::int32_t, feedback_age_at_use_us, -1) \
  READING(std::int32_t, command_age_us, -1)

#define RC10_MOTOR_READINGS(READING) RC10_TICK_READINGS(READING) RC10_FEEDBACK_READINGS(READING)
