#pragma once

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// The keys of the motor's family, with their defaults; those of others mean nothing here. False: one is
/// wrong or missing.
[[nodiscard]] bool readOwnKeys(MotorParse& in);
/// Check by the family. False: it has refused.
[[nodiscard]] bool checkOwnKeys(MotorParse& in);

}  // namespace rc10
