#pragma once

#include <string>

#include "app/result.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// The scan that a request asks for: its target is a bus, or the interface of one. The error names the value
/// and its range, or the buses.
[[nodiscard]] Result<BusScanOrder> parseScan(const link::Request& request, const RobotDescription& robot);

/// The motors of a bus.
[[nodiscard]] MotorSet motorsOf(const RobotDescription& robot, std::size_t bus);

/// Reason why a scan was not made, or not to its end, with the way out; empty: it was.
[[nodiscard]] std::string whyNoScan(const Order& order, const OrderResult& result,
                                    const RobotDescription& robot);

}  // namespace rc10
