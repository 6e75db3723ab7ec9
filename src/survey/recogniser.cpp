#include "survey/recogniser.hpp"

#include "drives/families.hpp"

namespace rc10::survey {

std::vector<DriveGuess> recognise(const CanFrame& frame) {
  std::vector<DriveGuess> guesses;
  if (frame.type != FrameType::kData) return guesses;
  for (const auto& entry : builtInFamilies()) {
    if (entry.recognise != nullptr) entry.recognise(frame, guesses);
  }
  return guesses;
}

}  // namespace rc10::survey
