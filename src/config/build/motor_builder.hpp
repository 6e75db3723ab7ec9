#pragma once

#include <string>

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// A motor as far as it could be read, with what checks across motors need to name it.
struct MotorDraft {
  MotorConfig config;
  std::string path;  ///< "buses[0].motors[2]"
  SourcePlace id_place;
  bool complete = false;  ///< Model, id and command are known and fit together.
};

/// "'lift' (M3508 id 1)"
[[nodiscard]] std::string nameOf(const MotorDraft& motor);

/// `tick_hz`: of the scheduler. `settings`: the motor's own keys over those of its profile, already held
/// against the tables.
[[nodiscard]] MotorDraft buildMotor(const Settings& settings, const SourcePlace& place,
                                    const std::string& path, int tick_hz, Problems& problems);

}  // namespace rc10
