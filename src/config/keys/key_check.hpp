#pragma once

#include <string>

#include "config/keys/key_table.hpp"
#include "config/yaml/problem.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// Holds a map against its table, all the way down: unknown and missing keys, wrong kinds, numbers out
/// of range. Reported values are marked refused, so that later checks pass them over.
void checkKeys(YamlNode& node, const Section& section, const std::string& path, Problems& problems);

/// Error for a key that is none of `known`. `listed`: how they are named where none is near; in the
/// order of `known`.
[[nodiscard]] std::string unknownKeyWords(std::string_view typed, const std::vector<std::string_view>& known,
                                          const std::vector<std::string_view>& listed);

}  // namespace rc10
