#pragma once

#include "config/robot_config.hpp"
#include "sim/sim_bus.hpp"

namespace rc10 {

/// Simulation in place of the motors of a bus.
[[nodiscard]] sim::SimBusConfig simulatedBus(const BusConfig& config);

}  // namespace rc10
