#pragma once

#include "config/build/motor_reading.hpp"

namespace rc10 {

/// Slew and soft limits, and how a target approaches them.
void readShaping(MotorReading& in);

}  // namespace rc10
