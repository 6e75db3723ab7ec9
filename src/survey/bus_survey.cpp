#include "survey/bus_survey.hpp"

#include <algorithm>

#include "drives/families.hpp"
#include "survey/harmless_queries.hpp"

namespace rc10::survey {
namespace {

void dropTooFrequent(Sighting& sighting, Duration listened) {
  if (listened <= Duration{0}) return;
  const bool others = std::any_of(sighting.guesses.begin(), sighting.guesses.end(),
                                  [](const DriveGuess& guess) { return guess.most_hz == 0.0F; });
  if (!others) return;
  std::erase_if(sighting.guesses, [&](const DriveGuess& guess) {
    return guess.most_hz > 0.0F && static_cast<float>(sighting.frames) > guess.most_hz * seconds(listened);
  });
}

}  // namespace

bool Sighting::ambiguous() const {
  return std::any_of(guesses.begin(), guesses.end(), [this](const DriveGuess& g) {
    return g.kind != guesses.front().kind || g.from_drive != guesses.front().from_drive;
  });
}

void BusSurvey::take(const CanFrame& frame) {
  if (frame.type != FrameType::kData) return;
  const std::pair key{frame.id.extended, frame.id.value};
  if (heard_.size() >= kMostIds && !heard_.contains(key)) return;
  auto& heard = heard_[key];
  ++heard.frames;
  for (const auto& guess : recognise(frame)) {
    const auto known = std::find_if(heard.guesses.begin(), heard.guesses.end(),
                                    [&](const auto& g) { return g.first == guess; });
    if (known == heard.guesses.end())
      heard.guesses.emplace_back(guess, 1);
    else
      ++known->second;
  }
}

std::vector<Sighting> BusSurvey::sightings(Duration listened) const {
  std::vector<Sighting> sightings;
  for (const auto& [key, heard] : heard_) {
    Sighting sighting{.id = {key.second, key.first}, .frames = heard.frames, .guesses = {}};
    for (const auto& [guess, count] : heard.guesses) {
      // One frame that a kind cannot have sent, and it is none of that kind.
      std::uint64_t of_kind = 0;
      for (const auto& [other, others] : heard.guesses)
        if (other.kind == guess.kind && other.from_drive == guess.from_drive) of_kind += others;
      if (of_kind >= heard.frames) sighting.guesses.push_back(guess);
    }
    dropTooFrequent(sighting, listened);
    sightings.push_back(std::move(sighting));
  }
  return sightings;
}

std::string BusSurvey::commandedBy(const CanFrame& query) const {
  for (const auto& entry : builtInFamilies()) {
    const auto obeying = entry.obeyed_by != nullptr ? entry.obeyed_by(query.id) : std::nullopt;
    if (!obeying) continue;
    const auto found = heard_.find({obeying->shown.extended, obeying->shown.value});
    if (found == heard_.end()) continue;
    const auto& guesses = found->second.guesses;
    const bool shown = std::any_of(guesses.begin(), guesses.end(),
                                   [&](const auto& guess) { return guess.first == obeying->drive; });
    if (shown) return std::string{obeying->name} + " " + std::to_string(obeying->drive.id);
  }
  return commandedByAnswerTo(query);
}

std::string BusSurvey::commandedByAnswerTo(const CanFrame& query) const {
  for (const auto& [key, heard] : heard_) {
    const auto& [extended, id] = key;
    if (!isAnsweredTo(query.id, {id, extended})) continue;
    const auto drive = id & 0xFFU;
    for (const auto& [guess, count] : heard.guesses) {
      if (guess.from_drive && static_cast<std::uint32_t>(guess.id) == drive)
        return std::string{guess.kind} + " " + std::to_string(drive) + ", by an answer";
    }
  }
  return {};
}

}  // namespace rc10::survey
