#pragma once

#include <cstdint>

#include "app/event_code.hpp"

namespace rc10 {
inline namespace robot_client {

inline constexpr std::int32_t kMotorStatus = static_cast<std::int32_t>(EventCode::kMotorStatus);

// Events about setpoints and commands that do not act: docs/lcm.md.
inline constexpr std::int32_t kSetpointSkipped = static_cast<std::int32_t>(EventCode::kSetpointSkipped);
inline constexpr std::int32_t kNotOwner = static_cast<std::int32_t>(EventCode::kNotOwner);
inline constexpr std::int32_t kCommandRefused = static_cast<std::int32_t>(EventCode::kCommandRefused);
inline constexpr std::int32_t kOtherDefinitions = static_cast<std::int32_t>(EventCode::kOtherDefinitions);

}  // namespace robot_client
}  // namespace rc10
