#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "config/yaml/problem.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// Limits of one document. A configuration of 4 buses with 32 motors each stays well below.
struct YamlLimits {
  static constexpr std::size_t kDepth = 16;        ///< Maps and lists inside each other.
  static constexpr std::size_t kNodes = 20'000;    ///< Values and keys; an alias counts as all it stands for.
  static constexpr std::size_t kTextBytes = 1024;  ///< Size limit of one value or key.
};

/// Reads exactly one YAML document. Nothing, and at least one error, if it is not YAML, empty, several
/// documents or beyond the limits.
[[nodiscard]] std::optional<YamlNode> readYaml(std::string_view text, Problems& problems);

}  // namespace rc10
