#pragma once

#include "drives/recogniser.hpp"

namespace rc10 {

/// See Recogniser.
void recogniseRobstride(const CanFrame& frame, std::vector<DriveGuess>& guesses);

/// Every RobStride and CyberGear for its serial number (type 0).
[[nodiscard]] const ScanQuestions& robstrideQuestions() noexcept;

}  // namespace rc10
