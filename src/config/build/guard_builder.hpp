#pragma once

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// Limits whose excess is a fault, and the speed of a standstill.
void readGuard(MotorParse& in);

}  // namespace rc10
