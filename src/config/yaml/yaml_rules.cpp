#include "config/yaml/yaml_rules.hpp"

#include <map>
#include <string>

namespace rc10 {
namespace {

class RuleCheck {
 public:
  explicit RuleCheck(Problems& problems) : problems_(problems) {}

  void value(YamlNode& node, const std::string& path) {
    checkTag(node, path);
    for (std::size_t i = 0; i < node.items.size(); ++i) value(node.items[i], joinPath(path, i));
    std::map<std::string_view, SourcePlace> seen;
    for (auto& [key, entry] : node.entries) {
      const std::string entry_path = joinPath(path, key.text);
      if (checkKey(key, entry_path)) checkTwice(key, seen, entry_path);
      value(entry, entry_path);
    }
  }

 private:
  void refuse(YamlNode& node, const std::string& path, std::string text) {
    problems_.error(node.place, path, std::move(text));
    node.refused = true;
  }

  void checkTag(YamlNode& node, const std::string& path) {
    if (!node.tag.empty()) refuse(node, path, "tags are not accepted; remove the '!...' before the value");
  }

  /// Whether it is a key that can be looked up.
  bool checkKey(YamlNode& key, const std::string& path) {
    if (key.kind != YamlNode::Kind::kScalar) {
      refuse(key, path,
             std::string{"a key is "} + std::string{kindWords(key)} + "; write a name before the colon");
    } else if (key.text == "<<") {
      refuse(key, path, "merge keys are not accepted; use a profile, or write the keys out");
    } else {
      checkTag(key, path);
    }
    return !key.refused;
  }

  void checkTwice(YamlNode& key, std::map<std::string_view, SourcePlace>& seen, const std::string& path) {
    const auto [first, is_new] = seen.emplace(key.text, key.place);
    if (is_new) return;
    const auto& place = first->second;
    refuse(key, path,
           "given twice, first at " + std::to_string(place.line) + ":" + std::to_string(place.column) +
               "; keep one");
  }

  Problems& problems_;
};

}  // namespace

void checkYamlRules(YamlNode& root, Problems& problems) { RuleCheck{problems}.value(root, ""); }

}  // namespace rc10
