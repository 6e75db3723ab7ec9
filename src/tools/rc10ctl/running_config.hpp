#pragma once

#include <cstddef>
#include <optional>

#include "config/robot_config.hpp"
#include "session.hpp"

namespace rc10::ctl {

/// The file with which the robot started, as rc10d leaves it beside its socket; nothing where this user may
/// not read it, or it has families or modules of a program of its own. Conclusions from it are advice.
[[nodiscard]] std::optional<RobotConfig> runningConfig(const Global& global, const link::Welcome& welcome);

/// The motor at this place of the robot's list; null: none.
[[nodiscard]] const MotorConfig* motorAt(const RobotConfig& config, std::size_t place);

}  // namespace rc10::ctl
