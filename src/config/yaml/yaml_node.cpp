#include "config/yaml/yaml_node.hpp"

#include <algorithm>

namespace rc10 {

const YamlNode* YamlNode::find(std::string_view key) const noexcept {
  const auto found = std::find_if(entries.begin(), entries.end(), [key](const YamlEntry& entry) {
    return entry.key.kind == Kind::kScalar && entry.key.text == key;
  });
  return found == entries.end() ? nullptr : &found->value;
}

std::string_view kindWords(const YamlNode& node) noexcept {
  switch (node.kind) {
    case YamlNode::Kind::kNull: return "empty";
    case YamlNode::Kind::kScalar: return "a single value";
    case YamlNode::Kind::kList: return "a list";
    case YamlNode::Kind::kMap: return "a map";
  }
  return "unknown";
}

}  // namespace rc10
