#pragma once

#include "config/build/motor_reading.hpp"

namespace rc10 {

/// on_timeout, on_disable and on_estop, as far as the drive can.
void readFallbacks(MotorReading& in);

}  // namespace rc10
