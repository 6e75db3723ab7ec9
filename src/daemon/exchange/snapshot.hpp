#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "app/motor_readings.hpp"
#include "app/time.hpp"
#include "bus/fdcan_bus.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/stop.hpp"
#include "motor/guarding/motor_guard.hpp"

namespace rc10 {

inline constexpr std::size_t kMaxBuses = link::kMaxBuses;

struct MotorSnapshot {
  MotorFeedback feedback;
  Target target;
#define RC10_FIELD(type, name, initial) type name = std::numeric_limits<type>::quiet_NaN();
  RC10_TICK_READINGS(RC10_FIELD)
#undef RC10_FIELD
  MonotonicTime command_received{};  ///< Time of the command in force, a module's: its tick; 0: none is.
  Acting acting = Acting::kNothing;
  Stop stop;                     ///< Reason why it does not obey.
  std::uint64_t enabled_by = 0;  ///< Order that enabled it last. The return of its group is none.
  std::uint32_t limits = 0;
  FaultCode fault = FaultCode::kNone;
  MotorStatus status = MotorStatus::kOffline;
  CommandUnit command_unit = CommandUnit::kNone;
  link::Name owner;
};

/// Microseconds from one time to another, as clients are told.
[[nodiscard]] inline std::int32_t ageUs(MonotonicTime since, MonotonicTime now) noexcept {
  const auto age = std::chrono::duration_cast<std::chrono::microseconds>(now - since).count();
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(age, 0, INT32_MAX));
}

/// Microseconds since the last feedback; -1: there was none.
[[nodiscard]] inline std::int32_t feedbackAgeUs(const MotorFeedback& feedback, MonotonicTime now) noexcept {
  return feedback.samples == 0 ? -1 : ageUs(feedback.received, now);
}

/// Microseconds since the command in force was received; -1: none is.
[[nodiscard]] inline std::int32_t commandAgeUs(const MotorSnapshot& motor, MonotonicTime now) noexcept {
  return motor.command_received == MonotonicTime{} ? -1 : ageUs(motor.command_received, now);
}

struct BusSnapshot {
  BusCounters counters;
  BusState state = BusState::kActive;
  int tec = -1;
  int rec = -1;
  std::uint64_t error_frames = 0;
  std::uint64_t restarts = 0;
};

inline constexpr std::size_t kMaxModules = link::kMaxModules;

struct ModuleSnapshot {
  link::Name owner;                 ///< Client that gives its inputs; empty: none.
  MonotonicTime inputs_received{};  ///< Time of the newest, a module's: its tick; 0: none act.
  std::array<double, kMaxSignals> outputs{};
};

/// State that the scheduler publishes to the link thread after each tick.
struct Snapshot {
  MonotonicTime time;
  MonotonicTime sent;  ///< After the frames of the tick were handed to the kernel.
  std::uint64_t tick = 0;
  std::uint64_t missed_ticks = 0;
  std::uint64_t expired_commands = 0;   ///< Arrived in the tick after their deadline.
  std::uint64_t refused_commands = 0;   ///< A motor was held by another client.
  std::uint64_t skipped_setpoints = 0;  ///< For motors that were not ACTIVE or not referenced.
  std::uint64_t refused_signals = 0;    ///< A module was held by another client, or the message was old.
  std::uint64_t events_dropped = 0;
  RobotStatus state = RobotStatus::kRun;
  Stop stop;                ///< Reason why it is not in RUN.
  MonotonicTime stopped{};  ///< When it left RUN; 0: it is in RUN.
  std::uint32_t estops = 0;
  std::uint32_t conditions = 0;  ///< Bits of Condition, as far as they may change.
  std::size_t motor_count = 0;
  std::size_t bus_count = 0;
  std::array<MotorSnapshot, kMaxMotors> motors;
  std::array<BusSnapshot, kMaxBuses> buses;
  std::size_t module_count = 0;
  std::array<ModuleSnapshot, kMaxModules> modules;
};

}  // namespace rc10
