#pragma once

#include <string>
#include <string_view>

#include "link/link_protocol.hpp"

namespace rc10::client {

/// Reason why the motor cannot take setpoints, and the remedy; empty if it can.
[[nodiscard]] std::string obstacle(const link::State& state, const std::string& name,
                                   const link::MotorState& motor);

/// A motor ceases to obey: it was ACTIVE, or about to be.
[[nodiscard]] bool leavesActive(const link::Event& event);
/// The robot stops: an e-stop, or the end of rc10d.
[[nodiscard]] bool leavesRun(const link::Event& event);

/// Text of an event that tells why targets of the client for the motor do not act; empty: another event.
[[nodiscard]] std::string refusalText(const link::Event& event, std::string_view motor,
                                      std::string_view client);

/// The owner of a motor, with the way to end it: a module's name is not that of a program.
[[nodiscard]] std::string holder(const link::Welcome& welcome, std::string_view owner);

}  // namespace rc10::client
