#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// A board of one's own on a serial port: fields that it sends are outputs, fields that it is sent inputs.
[[nodiscard]] const ModuleType& serialLinkType() noexcept;

}  // namespace rc10
