#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "link/link_protocol.hpp"

namespace rc10::web {

/// The signal of each tick with this name: "yaw.velocity_rpm" of a motor, "base.vx_m_per_s" of a module;
/// empty: the robot has none of this name.
[[nodiscard]] std::optional<link::TraceSignal> traceSignalOf(std::string_view name,
                                                             const link::Welcome& robot,
                                                             const std::vector<link::ModuleInfo>& modules);

}  // namespace rc10::web
