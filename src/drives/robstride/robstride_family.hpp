#pragma once

#include <cstdint>

#include "motor/motor_family.hpp"

namespace rc10 {

/// RobStride and CyberGear, on their private protocol.
[[nodiscard]] const MotorFamily& robstrideFamily() noexcept;

/// Control of a drive: a choice for the motor's whole life, because a drive changes its run mode
/// only while it is stopped.
enum class RobstrideControl : std::uint8_t {
  kOperation,  ///< Stiffness, damping and torque in every frame.
  kCurrent,    ///< The run modes: references are parameters.
  kVelocity,
  kPosition,
};
[[nodiscard]] RobstrideControl robstrideControlOf(const OwnValues& own);

}  // namespace rc10
