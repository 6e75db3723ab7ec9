#pragma once

#include <string_view>

#include "config/build/motor_parse.hpp"

namespace rc10 {

/// Slew and soft limits, and how a target approaches them.
void readShaping(MotorParse& in);

/// Whether something slows a shaft down that a current has made too fast: a gain, a known speed per effort,
/// or the drive's velocity loop. Known after readShaping.
[[nodiscard]] bool slowsDown(const ShapingConfig& shaping) noexcept;

/// Refuses a key that binds the speed of a motor which nothing slows down.
void refuseWithoutBrake(MotorParse& in, std::string_view key);

}  // namespace rc10
