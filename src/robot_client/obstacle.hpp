#pragma once

#include <optional>
#include <string>

#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {

/// Why a motor would not act on a setpoint of this mode, in words that tell what to do. Who holds it does not
/// count: a higher priority takes it over.
[[nodiscard]] std::optional<std::string> obstacle(const RobotState& state, const std::string& motor,
                                                  Mode mode);

}  // namespace robot_client
}  // namespace rc10
