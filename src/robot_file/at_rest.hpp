#pragma once

#include <string>

#include "app/result.hpp"
#include "link/link_protocol.hpp"

namespace rc10::robot_file {

/// A restart takes torque from no motor, and ends no e-stop and no fault that somebody has to clear. Every
/// motor is READY without torque, or OFFLINE; the error names the first that is not.
[[nodiscard]] Result<void> atRest(const link::Welcome& robot, const link::State& state);

/// The same of the robot that answers at its socket, which is to be that of the process.
[[nodiscard]] Result<void> robotAtRest(const std::string& robot, int pid);

}  // namespace rc10::robot_file
