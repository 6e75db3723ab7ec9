#include "config/keys/key_check.hpp"

#include <algorithm>

#include "app/nearest.hpp"
#include "config/keys/value_check.hpp"
#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

using Kind = YamlNode::Kind;

class KeyCheck {
 public:
  explicit KeyCheck(Problems& problems) : problems_(problems) {}

  void section(YamlNode& node, const Section& section, const std::string& path) {
    if (node.kind != Kind::kMap) return refuse(node, path, wrongKind(node, "a map of keys"));
    for (auto& [key, value] : node.entries) {
      if (key.kind != Kind::kScalar || key.refused) continue;
      const std::string value_path = joinPath(path, key.text);
      const Key* known = findKey(section, key.text);
      if (known == nullptr) {
        refuse(key, value_path, unknownKey(key.text, section));
      } else if (!value.refused) {
        checkValue(value, *known, value_path);
      }
    }
    checkRequired(node, section, path);
  }

 private:
  void refuse(YamlNode& node, const std::string& path, std::string text) {
    problems_.error(node.place, path, std::move(text));
    node.refused = true;
  }

  static std::string wrongKind(const YamlNode& node, const std::string& wanted) {
    return "is " + std::string{kindWords(node)} + "; write " + wanted;
  }

  std::string unknownKey(std::string_view text, const Section& section) const {
    std::vector<std::string_view> known;
    for (const Key& key : section.keys()) known.push_back(key.name);
    return unknownKeyWords(problems_.full() ? std::string_view{} : text, known, known);
  }

  void checkRequired(YamlNode& node, const Section& section, const std::string& path) {
    for (const Key& key : section.keys()) {
      if (!key.required || node.find(key.name) != nullptr) continue;
      problems_.error(node.place, joinPath(path, key.name), "is missing; add it: " + std::string{key.about});
    }
  }

  void checkValue(YamlNode& node, const Key& key, const std::string& path) {
    switch (key.kind) {
      case ValueKind::kSection: return section(node, *key.section, path);
      case ValueKind::kTextList: return textList(node, key, path);
      case ValueKind::kSectionList: return sectionList(node, key, path);
      case ValueKind::kNamedSections: return namedSections(node, key, path);
      case ValueKind::kTypedSections: return typedSections(node, key, path);
      default: break;
    }
    if (node.kind != Kind::kScalar) return refuse(node, path, wrongKind(node, wantedWords(key)));
    if (auto reason = whyNoValue(node, key); !reason.empty()) refuse(node, path, std::move(reason));
  }

  void sectionList(YamlNode& node, const Key& key, const std::string& path) {
    if (node.kind != Kind::kList) return refuse(node, path, wrongKind(node, wantedWords(key)));
    checkCount(node.items.size(), node, key, path);
    for (std::size_t i = 0; i < node.items.size(); ++i)
      section(node.items[i], *key.section, joinPath(path, i));
  }

  void typedSections(YamlNode& node, const Key& key, const std::string& path) {
    if (node.kind != Kind::kList) return refuse(node, path, wrongKind(node, wantedWords(key)));
    checkCount(node.items.size(), node, key, path);
    for (std::size_t i = 0; i < node.items.size(); ++i)
      typedSection(node.items[i], *key.types, joinPath(path, i));
  }

  /// Without its type nothing can be said of its keys.
  void typedSection(YamlNode& node, const SectionTypes& types, const std::string& path) {
    if (node.kind != Kind::kMap) return refuse(node, path, wrongKind(node, "a map of keys"));
    const YamlNode* type = node.find("type");
    const std::string type_path = joinPath(path, "type");
    if (type != nullptr && type->kind == Kind::kScalar && !type->refused) {
      if (const Section* known = types.find(type->text)) return section(node, *known, path);
      problems_.error(type->place, type_path, notOneOf(type->text, types.names()));
    } else if (type == nullptr) {
      const auto names = types.names();
      problems_.error(node.place, type_path,
                      "is missing; add it: one of " + listWords({names.begin(), names.end()}));
    } else if (!type->refused) {
      problems_.error(type->place, type_path, wrongKind(*type, "a text"));
    }
    node.refused = true;
  }

  void textList(YamlNode& node, const Key& key, const std::string& path) {
    if (node.kind != Kind::kList) return refuse(node, path, wrongKind(node, wantedWords(key)));
    checkCount(node.items.size(), node, key, path);
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      YamlNode& item = node.items[i];
      const std::string item_path = joinPath(path, i);
      if (item.kind != Kind::kScalar) {
        refuse(item, item_path, wrongKind(item, "a text"));
      } else if (auto reason = whyNoText(item, key); !reason.empty()) {
        refuse(item, item_path, std::move(reason));
      }
    }
  }

  void namedSections(YamlNode& node, const Key& key, const std::string& path) {
    if (node.kind != Kind::kMap) return refuse(node, path, wrongKind(node, wantedWords(key)));
    checkCount(node.entries.size(), node, key, path);
    for (auto& [name, value] : node.entries) {
      if (name.kind != Kind::kScalar || name.refused) continue;
      const std::string value_path = joinPath(path, name.text);
      if (!matches(name.text, *key.form)) {
        refuse(name, value_path,
               inQuotes(name.text) + " is not accepted as a name; use " + std::string{key.form->words});
      }
      if (!value.refused) section(value, *key.section, value_path);
    }
  }

  void checkCount(std::size_t count, const YamlNode& node, const Key& key, const std::string& path) {
    const auto items = static_cast<double>(count);
    if (items >= key.range.min && items <= key.range.max) return;
    problems_.error(node.place, path,
                    "has " + std::to_string(count) + " entries; " + useWords(key.range, ""));
  }

  Problems& problems_;
};

}  // namespace

std::string unknownKeyWords(std::string_view typed, const std::vector<std::string_view>& known,
                            const std::vector<std::string_view>& listed) {
  const auto meant = typed.empty() ? std::string_view{} : nearest(typed, known);
  const auto place = std::find(known.begin(), known.end(), meant);
  if (!meant.empty() && place != known.end()) {
    return "unknown key; did you mean " +
           std::string{listed[static_cast<std::size_t>(place - known.begin())]} + "?";
  }
  return "unknown key; known here: " + listWords({listed.begin(), listed.end()});
}

void checkKeys(YamlNode& node, const Section& section, const std::string& path, Problems& problems) {
  KeyCheck{problems}.section(node, section, path);
}

}  // namespace rc10
