#include "daemon/clients/gains_at_end.hpp"

#include <algorithm>

#include "daemon/clients/until_its_end.hpp"
#include "link/until_its_end.hpp"

namespace rc10 {

Result<bool> GainsAtEnd::askedBy(const link::Request& request, const Speaker& speaker) {
  return isAskedFor({.value = link::kRestoreAtEnd,
                     .lasting = "gains that stay",
                     .instead = "set the gains of before when you end"},
                    request, speaker);
}

void GainsAtEnd::tried(std::uint64_t connection, const link::Name& client, std::size_t motor,
                       const GainChange& before) {
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.motor == motor && entry.before.gain == before.gain;
  });
  if (known == entries_.end()) {
    entries_.push_back({.connection = connection, .client = client, .motor = motor, .before = before});
    return;
  }
  // A try after another: before both.
  known->connection = connection;
  known->client = client;
  known->refusals = 0;
}

void GainsAtEnd::settled(std::size_t motor, LoopGain gain) {
  std::erase_if(entries_,
                [&](const Entry& entry) { return entry.motor == motor && entry.before.gain == gain; });
}

bool GainsAtEnd::refused(std::size_t motor, LoopGain gain) {
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.motor == motor && entry.before.gain == gain;
  });
  return known != entries_.end() && ++known->refusals == kTries;
}

std::vector<GainsAtEnd::Due> GainsAtEnd::left() const {
  std::vector<Due> left;
  for (const auto& entry : entries_) {
    if (entry.refusals < kTries) continue;
    auto of_motor =
        std::find_if(left.begin(), left.end(), [&](const Due& each) { return each.motor == entry.motor; });
    if (of_motor == left.end())
      of_motor = left.insert(left.end(), {.motor = entry.motor, .client = entry.client, .gains = {}});
    of_motor->gains.values.at(of_motor->gains.count++) = entry.before;
  }
  return left;
}

std::optional<GainsAtEnd::Due> GainsAtEnd::due(const std::function<bool(std::uint64_t)>& is_open) const {
  std::optional<Due> due;
  for (const auto& entry : entries_) {
    if (entry.refusals >= kTries || is_open(entry.connection) || (due && due->motor != entry.motor)) continue;
    if (!due) due = Due{.motor = entry.motor, .client = entry.client, .gains = {}};
    due->gains.values.at(due->gains.count++) = entry.before;
  }
  return due;
}

}  // namespace rc10
