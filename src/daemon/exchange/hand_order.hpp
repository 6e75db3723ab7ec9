#pragma once

#include <cstddef>

#include "sim/hand.hpp"

namespace rc10 {

/// Place of a simulated drive.
struct SimulatedDrive {
  std::size_t port = 0;   ///< Place among the simulated buses, in the file's order.
  std::size_t drive = 0;  ///< On that bus.
  int direction = 1;      ///< Direction of its motor: the drive itself knows none.
};

/// A hand for one of them.
struct HandOrder {
  SimulatedDrive of;
  sim::Hand hand;
};

}  // namespace rc10
