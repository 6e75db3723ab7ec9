#include "config/check/untested_loops.hpp"

#include <cstddef>
#include <string_view>

namespace rc10 {

std::vector<std::string> untestedLoops(const MotorConfig& motor) {
  const Provision damp = motor.traits().frames.damp;
  std::vector<std::string> lines;
  const auto look = [&lines, damp](std::string_view key, FallbackAction action) {
    // A damp that rc10d computes is a current against the speed that the encoder tells.
    const bool lets_go =
        action == FallbackAction::kCoast || (action == FallbackAction::kDamp && damp != Provision::kHostLoop);
    if (lets_go) return;
    lines.emplace_back(key).append(": ").append(kFallbackWords[static_cast<std::size_t>(action)]);
  };
  look("on_timeout", motor.fallback.on_timeout);
  look("on_disable", motor.fallback.on_disable);
  look("on_estop", motor.fallback.on_estop);
  return lines;
}

}  // namespace rc10
