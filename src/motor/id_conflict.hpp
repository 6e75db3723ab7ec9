#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "motor/motor_settings.hpp"

namespace rc10 {

/// Motors of one family whose ids do not go together on one bus; by their places in the list that was judged.
struct IdConflict {
  std::vector<std::size_t> motors;
  std::size_t blamed = 0;
  std::string text;  ///< Goes on after their names: "both answer with 0x201; ...".
};

/// All conflicts among the motors of its family on one bus.
using IdJudge = std::vector<IdConflict> (*)(std::span<const MotorSettings> motors);

}  // namespace rc10
