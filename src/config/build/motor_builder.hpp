#pragma once

#include <string>

#include "config/check/motor_draft.hpp"
#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// `tick_hz`: of the scheduler. `settings`: the motor's own keys over those of its profile, already held
/// against the tables.
[[nodiscard]] MotorDraft buildMotor(const Settings& settings, const SourcePlace& place,
                                    const std::string& path, int tick_hz, Problems& problems);

}  // namespace rc10
