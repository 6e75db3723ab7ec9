#include "survey/bus_survey.hpp"

#include <algorithm>

#include "drives/odrive/odrive_frames.hpp"

namespace rc10::survey {

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

namespace {

// ODrive's come every 100 ms unless somebody wants them oftener. Feedback of a DJI motor at rest looks the
// same, and comes 1000 times a second.
constexpr float kMostHeartbeatsHz = 150.0F;

bool isOdrive(const DriveGuess& guess) {
  return guess.kind == drive_kind::kOdrive || guess.kind == drive_kind::kOdriveExtended;
}
bool isOdriveHeartbeat(CanId id) { return odrive::messageOf(id) == odrive::Message::kHeartbeat; }

void dropTooFrequent(Sighting& sighting, Duration listened) {
  const bool others = std::any_of(sighting.guesses.begin(), sighting.guesses.end(),
                                  [](const DriveGuess& g) { return !isOdrive(g); });
  const bool often =
      listened > Duration{0} && static_cast<float>(sighting.frames) > kMostHeartbeatsHz * seconds(listened);
  if (others && often && isOdriveHeartbeat(sighting.id)) std::erase_if(sighting.guesses, isOdrive);
}

}  // namespace

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

int BusSurvey::commandedBy(const CanFrame& query) const {
  if (!query.id.extended) return 0;
  const int node = static_cast<int>(query.id.value >> odrive::kMessageBits);
  const auto heartbeat = (query.id.value >> odrive::kMessageBits << odrive::kMessageBits) |
                         static_cast<std::uint32_t>(odrive::Message::kHeartbeat);
  const auto found = heard_.find({true, heartbeat});
  if (found == heard_.end()) return 0;
  const auto& guesses = found->second.guesses;
  const bool odrive = std::any_of(guesses.begin(), guesses.end(), [](const auto& guess) {
    return guess.first.kind == drive_kind::kOdriveExtended;
  });
  return odrive ? node : 0;
}

}  // namespace rc10::survey
