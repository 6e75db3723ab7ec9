#pragma once

#include <string>

#include "app/result.hpp"
#include "bus/can_link_settings.hpp"

namespace rc10 {

/// Down, settings, no automatic restart, up. Down throws away what the controller and the kernel's queue
/// still held. Settings are read back before the interface goes up: with another bit rate it would destroy
/// the frames of others. Main or io thread. The error names the interface, what was refused, and the fix.
[[nodiscard]] Result<void> restartCanLink(const std::string& interface, const CanLinkSettings& wanted);

/// Whether this process may do that.
[[nodiscard]] bool mayManageLinks() noexcept;

}  // namespace rc10
