#pragma once

#include "client/json_line.hpp"
#include "link/link_protocol.hpp"

namespace rc10::client {

/// A sighting of a scan, for scripts and for the page. `motor` of a guess is null, if no motor of the robot's
/// file takes its frames.
[[nodiscard]] Json sightingJson(const link::Sighting& sighting);

}  // namespace rc10::client
