#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "app/motor_readings.hpp"

namespace rc10::link {

/// Readings of a motor that a trace can have of each tick, by the names of motor_readings.hpp, then the
/// states as numbers. Their order is the protocol's.
inline constexpr std::array kTraceReadings{std::string_view{"target"},
                                           std::string_view{"target_shaped"},
                                           std::string_view{"command_value"},
                                           std::string_view{"feedback_age_us"},
                                           std::string_view{"feedback_age_at_use_us"},
                                           std::string_view{"command_age_us"},
#define RC10_READING(type, name, initial) std::string_view{#name},
                                           RC10_FEEDBACK_READINGS(RC10_READING)
#undef RC10_READING
                                               std::string_view{"limits"},
                                           std::string_view{"status"},
                                           std::string_view{"acting"}};

enum class TraceSource : std::uint16_t { kMotor = 0, kModule = 1 };

/// One number of each tick.
struct TraceSignal {
  TraceSource source{};
  std::uint16_t index = 0;  ///< Index of the motor or the module in Welcome.
  std::uint16_t value = 0;  ///< Place in kTraceReadings, for a motor; output, for a module, by ModuleInfo.

  friend bool operator==(const TraceSignal&, const TraceSignal&) = default;
};

inline constexpr std::size_t kMaxTraceSignals = 32;
inline constexpr std::size_t kMaxTraceRows = 32;

/// Values of one tick, in the order of the signals; NaN: not reported.
struct TraceRow {
  std::int64_t mono_us = 0;
  std::int64_t tick = 0;
  std::array<double, kMaxTraceSignals> values{};
};

}  // namespace rc10::link
