#pragma once

#include <vector>

#include "config/check/motor_draft.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Motors of one family on one bus whose ids do not go together: of families that judge that themselves
/// (MotorFamily::idJudge()). Looks at complete drafts only.
void checkDriveIds(const std::vector<MotorDraft>& motors, Problems& problems);

}  // namespace rc10
