#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "rc10/command_t.hpp"
#include "rc10/request_t.hpp"

namespace rc10::test {

using Bytes = std::vector<std::byte>;

/// As any LCM client encodes it.
template <typename Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  const int size = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return bytes;
}

inline setpoint_t setpointFor(const std::string& motor, double value) {
  setpoint_t setpoint{};
  setpoint.motor = motor;
  setpoint.mode = setpoint_t::MODE_VELOCITY;
  setpoint.value = value;
  setpoint.velocity_ff_rpm = 1.25F;
  setpoint.torque_ff_nm = -0.5F;
  setpoint.stiffness_nm_per_rad = 3.5F;
  setpoint.damping_nms_per_rad = 0.125F;
  return setpoint;
}

inline command_t commandWith(int setpoints) {
  command_t command{};
  command.utime = 1'700'000'000'000'000;
  command.client = "teleop";
  command.session = -1234567890123456789;
  command.seq = 42;
  command.priority = -3;
  command.validity_ms = 80;
  command.setpoint_count = setpoints;
  for (int i = 0; i < setpoints; ++i) {
    command.setpoints.push_back(setpointFor("motor_" + std::to_string(i), 10.5 * i));
  }
  return command;
}

inline request_t requestWith(int values) {
  request_t request{};
  request.client = "teleop";
  request.session = 77;
  request.seq = 5;
  request.operation = "zero";
  request.target = "yaw,pitch";
  request.value_count = values;
  for (int i = 0; i < values; ++i) {
    named_value_t value;
    value.name = "value_" + std::to_string(i);
    value.value = -0.5 * i;
    request.values.push_back(value);
  }
  return request;
}

}  // namespace rc10::test
