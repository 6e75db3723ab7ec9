#pragma once

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// Slew and soft limits, and how a target approaches them.
void readShaping(MotorParse& in);

}  // namespace rc10
