#pragma once

#include "config/build/motor_parse.hpp"
#include "config/keys/settings.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Limits while a person is near; after the motor's other limits.
void readReduced(MotorParse& in);

/// A mode input without any reduced limit, and reduced limits without a mode input.
void checkModeInput(const Settings& top, const RobotConfig& robot, Problems& problems);

}  // namespace rc10
