#pragma once

#include "drives/recogniser.hpp"

namespace rc10 {

/// See Recogniser.
void recogniseOdrive(const CanFrame& frame, std::vector<DriveGuess>& guesses);

/// See ObeyedBy: a node with extended ids.
[[nodiscard]] std::optional<Obeying> odriveObeying(CanId question);

}  // namespace rc10
