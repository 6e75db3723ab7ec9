#pragma once

#include <string>

#include "doctor/can_link_check.hpp"
#include "doctor/host_files.hpp"

namespace rc10::ctl {

/// Facts of the kernel and the driver about a CAN interface; the wanted settings are left empty.
[[nodiscard]] doctor::CanLinkFacts readLink(const doctor::HostFiles& files, const std::string& interface);

}  // namespace rc10::ctl
