#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// The key of modules that sit on a serial port.
inline constexpr FamilyKey kPortKey{
    .name = "port",
    .kind = FamilyKey::Kind::kText,
    .required = true,
    .about = "The serial port. A name under /dev/serial/by-id stays the same whatever is plugged in first.",
    .pattern = "/[A-Za-z0-9_./:+-]{1,120}",
    .words = "an absolute path: /dev/ttyAMA0 or /dev/serial/by-id/..."};

}  // namespace rc10
