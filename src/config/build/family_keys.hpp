#pragma once

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// Reads the keys of the motor's family, defaults filled in; keys of others are errors. False: one is
/// wrong or missing.
[[nodiscard]] bool readOwnKeys(MotorParse& in);
/// Check by the family. False: it has refused.
[[nodiscard]] bool checkOwnKeys(MotorParse& in);

}  // namespace rc10
