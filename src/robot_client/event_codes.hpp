#pragma once

#include <cstdint>

namespace rc10 {
inline namespace robot_client {

// rc10d's events about setpoints and commands that do not act: docs/lcm.md.
inline constexpr std::int32_t kSetpointSkipped = 103;
inline constexpr std::int32_t kNotOwner = 104;
inline constexpr std::int32_t kCommandRefused = 202;
inline constexpr std::int32_t kOtherDefinitions = 400;

}  // namespace robot_client
}  // namespace rc10
