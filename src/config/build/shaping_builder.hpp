#pragma once

#include <string_view>

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// Slew and soft limits, and how a target approaches them.
void readShaping(MotorParse& in);

/// Refuses a key that bounds the speed where nothing slows down a shaft which a current has made too fast:
/// neither a known effort nor a velocity loop. After readShaping has read both.
void refuseWithoutBrake(MotorParse& in, std::string_view key);

}  // namespace rc10
