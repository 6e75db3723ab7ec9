#pragma once

#include <string>

#include "link/link_protocol.hpp"
#include "survey/bus_survey.hpp"
#include "survey/drive_claims.hpp"

namespace rc10::survey {

/// A sighting as it travels, without its request. `claims`: null, if no file is known.
[[nodiscard]] link::Sighting linkSighting(const Sighting& sighting, const std::string& advice,
                                          const DriveClaims* claims = nullptr);

/// "DJI GM6020 id 1"; with "commands for" in front, if another controller sent it.
[[nodiscard]] std::string nameOf(const link::ScanGuess& guess);

}  // namespace rc10::survey
