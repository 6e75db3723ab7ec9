#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "rc10/request.hpp"

namespace rc10 {
inline namespace robot_client {

/// The reasons in a message of rc10d, "enable: 1 of 3 motors (left, right: offline: ...; arm: in FAULT)".
/// `known`: whether something is a motor's name, since reasons have colons and semicolons of their own.
[[nodiscard]] std::vector<MotorReason> motorReasons(std::string_view message,
                                                    const std::function<bool(std::string_view)>& known);

}  // namespace robot_client
}  // namespace rc10
