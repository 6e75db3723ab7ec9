#include "survey/link_sighting.hpp"

#include <algorithm>

namespace rc10::survey {

link::Sighting linkSighting(const Sighting& sighting, const std::string& advice, const DriveClaims* claims) {
  link::Sighting out;
  out.frames = static_cast<std::int64_t>(sighting.frames);
  out.frame_id = sighting.id.value;
  out.extended = sighting.id.extended ? 1 : 0;
  out.ambiguous = sighting.ambiguous() ? 1 : 0;
  out.advice = advice;
  out.guess_count = static_cast<std::uint32_t>(std::min(sighting.guesses.size(), link::kMaxScanGuesses));
  for (std::size_t i = 0; i < out.guess_count; ++i) {
    const auto& guess = sighting.guesses[i];
    auto& told = out.guesses.at(i);
    told.kind = guess.kind;
    told.id = guess.id;
    told.from_drive = guess.from_drive ? 1 : 0;
    const auto claim = claims != nullptr && guess.from_drive ? claims->of(guess) : std::nullopt;
    if (!claim) continue;
    told.motor = claims->motors()[claim->motor].name;
    told.collides = claim->collides ? 1 : 0;
  }
  return out;
}

std::string nameOf(const link::ScanGuess& guess) {
  std::string name{guess.kind.view()};
  if (guess.id != 0) name += " id " + std::to_string(guess.id);
  return guess.from_drive != 0 ? name : "commands for " + name;
}

}  // namespace rc10::survey
