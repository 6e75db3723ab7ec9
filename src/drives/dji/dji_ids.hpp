#pragma once

#include <span>
#include <vector>

#include "motor/id_conflict.hpp"

namespace rc10 {

/// DJI drives on one bus that would answer with one id, or read one command frame in two ways. `motors` are
/// all of this family.
[[nodiscard]] std::vector<IdConflict> djiIdConflicts(std::span<const MotorSettings> motors);

}  // namespace rc10
