#pragma once

#include <vector>

#include "config/check/motor_draft.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// DJI drives on one bus that would answer with one id, or read one command frame in two ways. Looks at
/// complete drafts only.
void checkDriveIds(const std::vector<MotorDraft>& motors, Problems& problems);

}  // namespace rc10
