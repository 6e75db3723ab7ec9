#pragma once

#include <vector>

#include "drives/recogniser.hpp"

/// Which drives are on a bus, from their frames alone.
namespace rc10::survey {

/// All that this frame may be. Empty: no family that rc10d knows.
[[nodiscard]] std::vector<DriveGuess> recognise(const CanFrame& frame);

}  // namespace rc10::survey
