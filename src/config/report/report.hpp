#pragma once

#include <string>

#include "config/robot_config.hpp"

namespace rc10 {

/// Report of the robot for people: threads, buses with their predicted load, motors with ids, limits
/// and loops. Plain ASCII, aligned. `config` comes from loadRobotConfig().
[[nodiscard]] std::string describe(const RobotConfig& config);

/// "0x200 slot 1", "0x141 at 1000 Hz": frames that command a motor.
[[nodiscard]] std::string motorCommandText(const MotorConfig& motor);
/// "0x201 at 1000 Hz": frames in which it reports.
[[nodiscard]] std::string motorFeedbackText(const MotorConfig& motor);
/// Zero of its angle: "at power-on", "at 0 deg" of an absolute encoder, "on request".
[[nodiscard]] std::string motorZeroText(const MotorConfig& motor);
/// `on_estop`, with what it becomes in the end: "damp, after 1 s coast".
[[nodiscard]] std::string motorEstopText(const MotorConfig& motor);

}  // namespace rc10
