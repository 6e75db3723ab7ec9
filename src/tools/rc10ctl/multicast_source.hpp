#pragma once

#include <optional>

#include "doctor/multicast_check.hpp"

namespace rc10::ctl {

/// The address from which datagrams to `group` would leave, as the kernel chooses it; empty: no route.
[[nodiscard]] std::optional<doctor::Ipv4> multicastSource(const doctor::Ipv4& group);

}  // namespace rc10::ctl
