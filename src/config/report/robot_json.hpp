#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "config/check/bus_load.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

// Parts of a judgement and of a robot that `rc10ctl check --json` and the page show alike.

/// Errors or warnings, each with its place, its key's path, and its reason and fix.
[[nodiscard]] nlohmann::ordered_json problemsJson(const std::vector<ConfigProblem>& problems);

/// Motors of a bus in their order, each with its share of the load, as `motor_json` words one.
[[nodiscard]] nlohmann::ordered_json motorsJson(const BusConfig& bus, int rate_hz,
                                                nlohmann::ordered_json (*motor_json)(const MotorConfig&,
                                                                                     const BusLoad&));

/// Groups, with the names of their motors.
[[nodiscard]] nlohmann::ordered_json groupsJson(const RobotConfig& config);

}  // namespace rc10
