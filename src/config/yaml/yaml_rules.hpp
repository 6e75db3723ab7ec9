#pragma once

#include "config/yaml/problem.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// Reports what YAML allows and a configuration must not have, anywhere in the document: a key twice in
/// one map, merge keys, tags, keys that are no plain text. Reported values are marked refused.
void checkYamlRules(YamlNode& root, Problems& problems);

}  // namespace rc10
