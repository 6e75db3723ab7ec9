#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>

// Readings of a motor, one number each, at the output shaft: each line is a field of link::MotorState and, by
// its name, of motor_state_t.lcm, a key of rc10ctl's JSON and a signal of its verbs and of the page. The
// black box has those of its format. READING(type, name, initial); NaN: not reported.

/// Readings of the drive: fields of MotorFeedback and of the client library's MotorState, too. A
/// trace has them of each tick.
#define RC10_FEEDBACK_READINGS(READING)                \
  READING(double, total_angle_deg, 0.0) /* turns */    \
  READING(float, angle_deg, 0.0F)       /* [0, 360) */ \
  READING(float, velocity_rpm, 0.0F)                   \
  READING(float, current_a, 0.0F)                      \
  READING(float, torque_nm, 0.0F)                      \
  READING(float, voltage_v, 0.0F)                      \
  READING(float, temperature_c, 0.0F)

/// Readings that a tick computes: fields of MotorSnapshot and the client library's MotorState, too.
#define RC10_TICK_READINGS(READING)                              \
  READING(double, target_shaped, 0.0) /* NaN: no target acts. */ \
  READING(float, command_value, 0.0F) /* Last value sent to the drive, in command_unit. */

/// Readings of a state when it is published.
#define RC10_PUBLISHED_READINGS(READING)            \
  READING(float, feedback_hz, 0.0F)                 \
  READING(std::int32_t, feedback_age_us, -1)        \
  READING(std::int32_t, feedback_age_at_use_us, -1) \
  READING(std::int32_t, command_age_us, -1)

/// All, in the order of link::MotorState.
#define RC10_MOTOR_READINGS(READING) \
  READING(double, target, 0.0)       \
  RC10_TICK_READINGS(READING) RC10_PUBLISHED_READINGS(READING) RC10_FEEDBACK_READINGS(READING)

namespace rc10 {

// Each calls visit(name, field of each holder...) for the readings of its list, in their order: to copy or
// convert between structs that have them.
#define RC10_VISIT(type, name, initial) visit(std::string_view{#name}, holders.name...);
template <typename Visit, typename... Holders>
constexpr void visitFeedbackReadings(const Visit& visit, Holders&... holders) {
  RC10_FEEDBACK_READINGS(RC10_VISIT)
}
template <typename Visit, typename... Holders>
constexpr void visitTickReadings(const Visit& visit, Holders&... holders) {
  RC10_TICK_READINGS(RC10_VISIT)
}
template <typename Visit, typename... Holders>
constexpr void visitMotorReadings(const Visit& visit, Holders&... holders) {
  RC10_MOTOR_READINGS(RC10_VISIT)
}
#undef RC10_VISIT

/// For a visit: the first holder gets the fields of the second.
inline constexpr auto kCopyReading = [](std::string_view, auto& to, const auto& from) noexcept {
  to = static_cast<std::remove_reference_t<decltype(to)>>(from);
};

}  // namespace rc10
