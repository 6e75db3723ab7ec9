#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "link/link_protocol.hpp"
#include "session.hpp"

namespace rc10::ctl {

/// Outcome of a scan, by rc10ctl itself or by the rc10d that drives the bus.
struct ScanReport {
  std::string interface;
  std::string robot{};  ///< Robot of that rc10d; empty: no file is known.
  bool listen_only = false;
  std::vector<std::string> advice{};  ///< About the bus as a whole.
  std::vector<link::Sighting> sightings{};
};

/// A table and advice, or a line of JSON for each sighting and one for the bus.
void print(const Global& global, const ScanReport& report);

/// Lines of a message; at least one.
[[nodiscard]] std::vector<std::string> linesOf(std::string_view message);

}  // namespace rc10::ctl
