#pragma once

#include "config/robot_config.hpp"
#include "sim/sim_bus.hpp"

namespace rc10 {

/// What a simulator needs to stand in for the motors of a bus.
[[nodiscard]] sim::SimBusConfig simulatedBus(const BusConfig& config);

}  // namespace rc10
