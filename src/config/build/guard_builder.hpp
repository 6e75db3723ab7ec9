#pragma once

#include "config/build/motor_reading.hpp"

namespace rc10 {

/// Limits whose excess is a fault, and the speed of a standstill.
void readGuard(MotorReading& in);

}  // namespace rc10
