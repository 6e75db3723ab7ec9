#pragma once

#include <string>

#include "doctor/host_files.hpp"
#include "doctor/link_check.hpp"

namespace rc10::ctl {

/// Facts of the kernel and the driver about a CAN interface; the wanted settings are left empty.
[[nodiscard]] doctor::LinkFacts readLink(const doctor::HostFiles& files, const std::string& interface);

}  // namespace rc10::ctl
