#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "survey/recogniser.hpp"

namespace rc10::survey {

/// Frames heard under one id.
struct Sighting {
  CanId id;
  std::uint64_t frames = 0;
  /// Possible senders of all these frames. One kind: certain; several: ambiguous; empty: no family that rc10d
  /// knows. Drives that share the id are several of one kind.
  std::vector<DriveGuess> guesses;

  [[nodiscard]] bool ambiguous() const;
};

/// Collects the frames of a bus. Not for real-time threads: it allocates.
class BusSurvey {
 public:
  static constexpr std::size_t kMostIds =
      4096;  ///< A bus with more is no bus of motors: the rest is left out.

  void take(const CanFrame& frame);

  /// By id, standard ones first. `listened`: how long frames were taken; 0: how often a frame came says
  /// nothing.
  [[nodiscard]] std::vector<Sighting> sightings(Duration listened = {}) const;

  /// The drive that would take this query for a command of its own, in words, if it may have been heard: "an
  /// ODrive with extended ids, node 136". Empty: none.
  [[nodiscard]] std::string commandedBy(const CanFrame& query) const;

 private:
  struct Heard {
    std::uint64_t frames = 0;
    std::vector<std::pair<DriveGuess, std::uint64_t>> guesses;
  };
  /// The same, of the drive's answer.
  [[nodiscard]] std::string commandedByAnswerTo(const CanFrame& query) const;

  std::map<std::pair<bool, std::uint32_t>, Heard> heard_;
};

}  // namespace rc10::survey
