#pragma once

#include <string>
#include <vector>

#include "config/robot_config.hpp"

namespace rc10 {

/// Lines of the motor's file by which a loop acts on it once its target is over, it is disabled or an e-stop
/// comes: "on_timeout: hold". Before its first spin nobody knows whether its current has the sign of its
/// encoder; with the wrong one such a loop drives it on. Without a line it coasts, or its drive damps it.
[[nodiscard]] std::vector<std::string> untestedLoops(const MotorConfig& motor);

}  // namespace rc10
