#pragma once

#include <string>
#include <string_view>

#include "app/result.hpp"
#include "config/keys/loop_gains.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// The named values of a request, all of them or the first error.
[[nodiscard]] Result<GainChanges> parseGains(const link::Request& request, const MotorLoops& loops);

/// Applies the changes to these loops; in words: "velocity_pid.kp_a_per_rpm 0.25 -> 0.8, …".
[[nodiscard]] std::string applyGains(const GainChanges& changes, MotorLoops& loops);

/// Tried gains that rc10d could not set back: those in force, those of before, and the command for them.
[[nodiscard]] std::string leftGains(std::string_view motor, std::string_view client, const MotorLoops& loops,
                                    const GainChanges& before);

/// Every gain in force under its key.
void tellGains(const MotorLoops& loops, link::Response& response);

/// Reason why no gain of such a motor can be set or told; an error if rc10d closes no loop of it.
[[nodiscard]] Result<void> checkHasGains(std::string_view motor, const MotorLoops& loops);

}  // namespace rc10
