#pragma once

#include "client/json_line.hpp"
#include "config/robot_config.hpp"

namespace rc10::ctl {

/// Figures of describe(), for programs.
[[nodiscard]] client::Json robotJson(const RobotConfig& config);

}  // namespace rc10::ctl
