#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Either a complete robot, or everything that is wrong with its file.
struct ConfigOutcome {
  std::optional<RobotConfig> config;    ///< Absent exactly if there are errors.
  std::vector<ConfigProblem> errors;    ///< In the order of the file.
  std::vector<ConfigProblem> warnings;  ///< Worth printing; the robot works.
  std::string source;                   ///< Bytes that loadRobotConfig() read.

  [[nodiscard]] explicit operator bool() const noexcept { return config.has_value(); }
  /// One problem a line, each with a line feed.
  [[nodiscard]] std::string errorText() const;
  [[nodiscard]] std::string warningText() const;
  /// Both, in the order of the file, warnings marked as such.
  [[nodiscard]] std::string text() const;
};

/// Reads a configuration file. Never throws.
[[nodiscard]] ConfigOutcome loadRobotConfig(const std::string& path);

/// The same for text that is at hand; `file_name` is for messages.
[[nodiscard]] ConfigOutcome parseRobotConfig(std::string_view text, std::string file_name);

}  // namespace rc10
