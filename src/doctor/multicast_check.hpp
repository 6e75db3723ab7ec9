#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "doctor/finding.hpp"
#include "doctor/host_files.hpp"

namespace rc10::doctor {

using Ipv4 = std::array<std::uint8_t, 4>;

/// Where this computer sends datagrams for `group`, from /proc/net/route; empty: nowhere. LCM's multicast
/// goes the same way.
[[nodiscard]] std::string routeOf(const HostFiles& files, const Ipv4& group);

/// `source`: the address from which this computer's programs send there, as the kernel chooses it; empty: not
/// known. `ttl`: how far the configuration lets the datagrams go; 0: not off this computer.
[[nodiscard]] Finding checkMulticast(const std::string& interface, const std::optional<Ipv4>& source,
                                     const Ipv4& group, int ttl);

}  // namespace rc10::doctor
