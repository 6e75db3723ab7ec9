#pragma once

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// on_timeout, on_disable and on_estop, as far as the drive can.
void readFallbacks(MotorParse& in);

}  // namespace rc10
