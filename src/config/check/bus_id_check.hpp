#pragma once

#include <vector>

#include "config/check/motor_draft.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Drives of one bus, of whatever families, that could take each other's frames for their own, and drives
/// that do not speak the format of the bus. Each finding names both drives and proposes free ids. Two of
/// a family that judges its ids itself are left to checkDriveIds(). Looks at complete drafts only.
void checkBusIds(const std::vector<MotorDraft>& motors, const BusConfig& bus, Problems& problems);

}  // namespace rc10
