#pragma once

#include <set>
#include <string>
#include <vector>

#include "survey/bus_survey.hpp"

/// Advice about the frames heard on a bus, in words for people.
namespace rc10::survey {

/// The drive of this sighting has answered our question, and sends nothing by itself.
[[nodiscard]] bool isSilent(const Sighting& sighting, const std::vector<Sighting>& all);

/// About one sighting; empty: there is nothing to be done.
[[nodiscard]] std::string adviceFor(const Sighting& sighting, const std::vector<Sighting>& all);

/// Options with which a bus was asked.
struct Asking {
  bool listen_only = false;
  std::set<std::string>
      spared;  ///< Drives that some questions would have commanded: BusSurvey::commandedBy().
};

/// About the bus as a whole: why drives may be missing.
[[nodiscard]] std::vector<std::string> adviceForBus(const std::vector<Sighting>& all, const Asking& asking);

}  // namespace rc10::survey
