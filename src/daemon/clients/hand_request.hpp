#pragma once

#include <optional>
#include <string_view>

#include "app/result.hpp"
#include "daemon/exchange/hand_order.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// The hand that a request sets on the drive of this motor; no drive: the motor is not simulated here. The
/// error names the motor, the value and its range.
[[nodiscard]] Result<HandOrder> parseHand(const link::Request& request, std::string_view motor,
                                          const std::optional<SimulatedDrive>& drive);

}  // namespace rc10
