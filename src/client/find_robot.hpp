#pragma once

#include <optional>
#include <string>

#include "app/result.hpp"

namespace rc10 {

struct RobotSocket {
  std::string robot;
  std::string path;
};

/// The link socket of the named robot, or, without a name, of the only one that runs on this computer.
[[nodiscard]] Result<RobotSocket> findRobot(const std::optional<std::string>& name);

}  // namespace rc10
