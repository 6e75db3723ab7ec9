#include "client/sighting_json.hpp"

#include <algorithm>
#include <span>

namespace rc10::client {
namespace {

[[nodiscard]] Json textOrNull(std::string_view text) { return text.empty() ? Json(nullptr) : Json(text); }

}  // namespace

Json sightingJson(const link::Sighting& sighting) {
  Json guesses = Json::array();
  for (const auto& guess :
       std::span(sighting.guesses).first(std::min<std::size_t>(sighting.guess_count, link::kMaxScanGuesses)))
    guesses.push_back({{"kind", guess.kind.view()},
                       {"id", guess.id},
                       {"from_drive", guess.from_drive != 0},
                       {"motor", textOrNull(guess.motor.view())},
                       {"collides", guess.collides != 0}});
  return {{"frame_id", sighting.frame_id}, {"extended", sighting.extended != 0},
          {"frames", sighting.frames},     {"ambiguous", sighting.ambiguous != 0},
          {"guesses", std::move(guesses)}, {"advice", textOrNull(sighting.advice.view())}};
}

}  // namespace rc10::client
