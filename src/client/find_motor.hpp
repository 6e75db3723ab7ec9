#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "link/link_protocol.hpp"

namespace rc10::client {

/// The place of a motor in Welcome and State. The error lists the motors.
[[nodiscard]] Result<std::size_t> findMotor(const link::Welcome& welcome, std::string_view name);

/// "left, right, yaw"; printable.
[[nodiscard]] std::string motorNames(const link::Welcome& welcome);

}  // namespace rc10::client
