#pragma once

#include <string>

#include "doctor/host_files.hpp"
#include "doctor/link_check.hpp"

namespace rc10::ctl {

/// What the kernel and the driver say of a CAN interface; what is wanted of it is left empty.
[[nodiscard]] doctor::LinkFacts readLink(const doctor::HostFiles& files, const std::string& interface);

}  // namespace rc10::ctl
