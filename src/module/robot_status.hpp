#pragma once

#include <cstdint>

#include "app/vocabulary.hpp"

namespace rc10 {

/// Requests of a module to the robot, beside targets. Writing to drives is not among them: that takes a
/// person. kDisableUnasked: nobody has asked for it, and what is held or braked already stays so.
enum class RobotRequest : std::uint8_t { kEnable, kDisable, kDisableUnasked, kEstop, kClear, kZero };

}  // namespace rc10
