#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "config/keys/key_table.hpp"
#include "motor/loop_gain.hpp"
#include "motor/motor_traits.hpp"

namespace rc10 {

/// The key of the configuration behind a gain.
struct GainKey {
  LoopGain gain{};
  std::string_view loop;   ///< The key of its section: "velocity_pid".
  std::string_view brief;  ///< "kp": for who types it; unique in its loop.
  const Key* key = nullptr;

  /// "velocity_pid.kp_a_per_rpm"
  [[nodiscard]] std::string path() const { return std::string{loop} + "." + std::string{key->name}; }
};

/// The loops that rc10d closes for one motor, with the gains in force.
struct MotorLoops {
  std::string model;
  MotorTraits traits;
  CascadeConfig config;

  [[nodiscard]] bool onHost() const noexcept { return traits.host_loops != nullptr; }
};

/// Every key of a gain, of all motors, in the order of the tables.
[[nodiscard]] const std::vector<GainKey>& allGainKeys();
/// Those that mean something for this motor.
[[nodiscard]] std::vector<GainKey> gainKeysOf(const MotorLoops& loops);

/// A change that was asked for by name, such as "velocity_pid.kp_a_per_rpm", "kp_a_per_rpm" or
/// "velocity.kp", checked by the rules of the configuration. The error is "gain: reason; fix".
[[nodiscard]] Result<GainChange> gainChange(std::string_view name, double value, const MotorLoops& loops);

/// The gains in force as lines for the motor in the robot's file, one for each loop, without end of line
/// after the last. They may stand in a block and, after a comma, between braces.
[[nodiscard]] std::string gainLines(const MotorLoops& loops);

}  // namespace rc10
