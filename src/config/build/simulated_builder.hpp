#pragma once

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// The section `simulated`: the load of a simulated shaft and its changes.
void readSimulated(MotorParse& in);
/// Its drive's own id, once the model is known.
void readDriveId(MotorParse& in);

}  // namespace rc10
