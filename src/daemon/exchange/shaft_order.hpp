#pragma once

#include <cstddef>
#include <variant>

#include "sim/hand.hpp"
#include "sim/load_change.hpp"

namespace rc10 {

/// Place of a simulated drive.
struct SimulatedDrive {
  std::size_t port = 0;       ///< Place among the simulated buses, in the file's order.
  std::size_t drive = 0;      ///< On that bus.
  int direction = 1;          ///< `direction` of its motor; the drive has none.
  float payload_at_m = 0.0F;  ///< As in the robot's file.
};

/// A hand on the shaft of one of them, or another load.
struct ShaftOrder {
  SimulatedDrive of;
  std::variant<sim::Hand, sim::LoadChange> act;
};

}  // namespace rc10
