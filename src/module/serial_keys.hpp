#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// Keys of modules that sit on a serial port.
inline constexpr OwnKey kPortKey{
    .name = "port",
    .kind = OwnKey::Kind::kText,
    .required = true,
    .about = "The serial port. A name under /dev/serial/by-id stays the same whatever is plugged in first.",
    .pattern = "/[A-Za-z0-9_./:+-]{1,120}",
    .words = "an absolute path: /dev/ttyAMA0 or /dev/serial/by-id/..."};

constexpr OwnKey baudKey(std::string_view about) {
  return {.name = "baud",
          .kind = OwnKey::Kind::kInteger,
          .min = 1200,
          .max = 4'000'000,
          .default_text = "115200",
          .about = about};
}

}  // namespace rc10
