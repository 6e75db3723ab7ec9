#pragma once

#include "drives/recogniser.hpp"

namespace rc10 {

/// See FamilyEntry: master ids of any value, where the file gives them.
bool speaksDamiao(const CanFrame& frame, int id);
/// See Recogniser.
void recogniseDamiao(const CanFrame& frame, std::vector<DriveGuess>& guesses);

}  // namespace rc10
