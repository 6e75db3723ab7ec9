#pragma once

#include "config/keys/settings.hpp"
#include "motor/cascade.hpp"

namespace rc10 {

/// Whether the velocity loop is to be incremental: as given, else as in the defaults.
[[nodiscard]] bool wantsIncremental(const Settings& motor, const CascadeConfig& defaults);

/// The default loops with the keys that are given replaced.
[[nodiscard]] CascadeConfig buildLoops(const Settings& motor, const CascadeConfig& defaults, bool volts);

}  // namespace rc10
