#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// `led_strip`: WS2812 pixels on an SPI bus that show the state of the robot.
[[nodiscard]] const ModuleType& ledStripType() noexcept;

}  // namespace rc10
