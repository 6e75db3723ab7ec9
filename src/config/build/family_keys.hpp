#pragma once

#include "config/build/motor_reading.hpp"

namespace rc10 {

/// The keys of the motor's family, with their defaults; those of others mean nothing here. False: one is
/// wrong or missing.
[[nodiscard]] bool readOwnKeys(MotorReading& in);
/// Check by the family. False: it has refused.
[[nodiscard]] bool checkOwnKeys(MotorReading& in);

}  // namespace rc10
