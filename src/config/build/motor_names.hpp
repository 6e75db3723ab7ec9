#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// The motors of all buses by name, in the order of the file.
class MotorNames {
 public:
  explicit MotorNames(const std::vector<BusConfig>& buses);

  /// The place of the motor that is named there; else the problem is reported.
  [[nodiscard]] std::optional<std::size_t> find(const GivenValue& given, Problems& problems) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace rc10
