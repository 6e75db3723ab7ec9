#pragma once

#include <string>

#include "config/check/bus_load.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Error if the bus cannot carry what is planned, warning if it may become crowded.
void checkBusLoad(const BusConfig& bus, int rate_hz, const std::string& path, Problems& problems);

/// "55.5 %"
[[nodiscard]] std::string percentText(double fraction);
/// "55.5 % to 67.5 %"
[[nodiscard]] std::string loadText(const BusLoad& load);

}  // namespace rc10
