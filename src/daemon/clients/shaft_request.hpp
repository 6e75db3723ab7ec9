#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "daemon/exchange/shaft_order.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// The hand that a request sets on the shaft of this motor; no drive: the motor is not simulated here. The
/// error names the motor, the value and its range.
[[nodiscard]] Result<ShaftOrder> parseHand(const link::Request& request, std::string_view motor,
                                           const std::optional<SimulatedDrive>& drive);

/// The same of another load. Values are named and bounded as the keys of `simulated`; none: the load of the
/// start comes back.
[[nodiscard]] Result<ShaftOrder> parseLoad(const link::Request& request, std::string_view motor,
                                           const std::optional<SimulatedDrive>& drive);

/// The answer to a request that the simulation takes.
[[nodiscard]] std::string shaftInWords(const ShaftOrder& order, std::string_view motor);

}  // namespace rc10
