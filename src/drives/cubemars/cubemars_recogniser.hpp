#pragma once

#include "drives/recogniser.hpp"

namespace rc10 {

/// See Recogniser.
void recogniseCubemars(const CanFrame& frame, std::vector<DriveGuess>& guesses);

}  // namespace rc10
