#pragma once

#include "drives/recogniser.hpp"

namespace rc10 {

/// See Recogniser.
void recogniseDji(const CanFrame& frame, std::vector<DriveGuess>& guesses);

}  // namespace rc10
