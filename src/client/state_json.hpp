#pragma once

#include <string>

#include "link/link_protocol.hpp"

/// Messages of rc10d, each as one line of JSON for scripts. The keys are the field names of lcm_types/; modes
/// and states are words; what is not reported is null.
namespace rc10::client {

[[nodiscard]] std::string listJson(const link::Welcome& welcome);
[[nodiscard]] std::string stateJson(const link::Welcome& welcome, const link::State& state);
[[nodiscard]] std::string diagnosticsJson(const link::Welcome& welcome, const link::Diagnostics& diagnostics);

}  // namespace rc10::client
