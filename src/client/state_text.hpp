#pragma once

#include <string>

#include "link/link_protocol.hpp"

/// Messages of rc10d as text for people.
namespace rc10::client {

/// The robot and its motors, with a line for each.
[[nodiscard]] std::string listText(const link::Welcome& welcome);

/// State of every motor. `diagnostics` may be null: none received yet. `colour`: what acts, what is doubtful
/// and what is wrong stand out on a terminal.
[[nodiscard]] std::string stateText(const link::Welcome& welcome, const link::State& state,
                                    const link::Diagnostics* diagnostics, bool colour = false);

/// Lateness and load of the robot.
[[nodiscard]] std::string diagnosticsText(const link::Welcome& welcome, const link::Diagnostics& diagnostics);

/// The measured counterpart of a mode's target: the current for CURRENT, an angle for the angle modes, the
/// velocity for all others. NaN: not reported.
[[nodiscard]] double measured(const link::MotorState& motor, ControlMode mode) noexcept;
/// The unit of measured().
[[nodiscard]] const char* measuredUnit(ControlMode mode) noexcept;

/// Behaviour of a motor that nobody commands any more: "holds its place (on_timeout)".
[[nodiscard]] const char* whatActs(Acting acting) noexcept;

}  // namespace rc10::client
