#pragma once

#include <string_view>

#include "drives/recogniser.hpp"

namespace rc10 {

inline constexpr std::string_view kCubemarsMit = "CubeMars (MIT)";

/// See Recogniser.
void recogniseCubemars(const CanFrame& frame, std::vector<DriveGuess>& guesses);

}  // namespace rc10
