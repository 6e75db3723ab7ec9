#pragma once

#include "drives/recogniser.hpp"

namespace rc10 {

/// See Recogniser.
void recogniseVesc(const CanFrame& frame, std::vector<DriveGuess>& guesses);

/// Every VESC for a sign of life (PING).
[[nodiscard]] const ScanQuestions& vescQuestions() noexcept;

}  // namespace rc10
