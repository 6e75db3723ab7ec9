#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "app/target.hpp"
#include "app/time.hpp"
#include "link/link_protocol.hpp"

namespace rc10::test {

inline link::Setpoint setpoint(std::string_view motor, ControlMode mode, double value = 0.0) {
  link::Setpoint out;
  out.motor = motor;
  out.target.mode = mode;
  out.target.value = value;
  return out;
}

/// A command of client "planner", session 7.
inline link::Command linkCommand(std::int64_t seq, MonotonicTime received,
                                 std::initializer_list<link::Setpoint> setpoints) {
  link::Command out;
  out.client = "planner";
  out.session = 7;
  out.seq = seq;
  out.received_ns = received.time_since_epoch().count();
  for (const auto& entry : setpoints) out.setpoints[out.setpoint_count++] = entry;
  return out;
}

/// Time of a request that does not say when it was received.
inline constexpr MonotonicTime kAnyTime{};

/// A request of client "pilot", session 9.
inline link::Request linkRequest(std::int64_t seq, std::string_view operation, std::string_view target = {}) {
  link::Request out;
  out.client = "pilot";
  out.session = 9;
  out.seq = seq;
  out.operation = operation;
  out.target = target;
  return out;
}

}  // namespace rc10::test
