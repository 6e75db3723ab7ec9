#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "app/time.hpp"
#include "bus/fdcan_bus.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/states.hpp"
#include "motor/guarding/motor_guard.hpp"

namespace rc10 {

inline constexpr std::size_t kMaxBuses = link::kMaxBuses;

struct MotorSnapshot {
  MotorFeedback feedback;
  Target target;
  float command_value = 0.0F;
  std::uint32_t limits = 0;
  FaultCode fault = FaultCode::kNone;
  MotorStatus status = MotorStatus::kOffline;
  CommandUnit command_unit = CommandUnit::kNone;
  link::Name owner;
};

/// Microseconds since the last feedback, as clients are told; -1: there was none.
[[nodiscard]] inline std::int32_t feedbackAgeUs(const MotorFeedback& feedback, MonotonicTime now) noexcept {
  if (feedback.samples == 0) return -1;
  const auto age = std::chrono::duration_cast<std::chrono::microseconds>(now - feedback.received).count();
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(age, 0, INT32_MAX));
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
  link::Name owner;  ///< Client that gives its inputs; empty: none.
  std::array<double, kMaxSignals> outputs{};
};

/// State that the scheduler publishes to the link thread after each tick.
struct Snapshot {
  MonotonicTime time;
  std::uint64_t tick = 0;
  std::uint64_t missed_ticks = 0;
  std::uint64_t expired_commands = 0;   ///< Arrived in the tick after their deadline.
  std::uint64_t refused_commands = 0;   ///< A motor was held by another client.
  std::uint64_t skipped_setpoints = 0;  ///< For motors that were not ACTIVE or not referenced.
  std::uint64_t refused_signals = 0;    ///< A module was held by another client, or the message was old.
  std::uint64_t events_dropped = 0;
  RobotStatus state = RobotStatus::kRun;
  std::size_t motor_count = 0;
  std::size_t bus_count = 0;
  std::array<MotorSnapshot, kMaxMotors> motors;
  std::array<BusSnapshot, kMaxBuses> buses;
  std::size_t module_count = 0;
  std::array<ModuleSnapshot, kMaxModules> modules;
};

}  // namespace rc10
