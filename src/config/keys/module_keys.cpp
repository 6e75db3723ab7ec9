#include "config/keys/module_keys.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <vector>

#include "config/keys/key_table.hpp"
#include "config/module_types.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

constexpr TextForm kMotorName{"[a-z0-9_]{1,31}", "the name of a motor"};
constexpr TextForm kAnyText{".{1,128}", "a text of 1 to 128 characters"};

constexpr std::array kCommonKeys{
    Key{.name = "name",
        .kind = kText,
        .form = &kNameForm,
        .required = true,
        .about = "Name of the module, unique: its LCM channels are <robot>.v1.<name> and "
                 "<robot>.v1.<name>.state."},
    Key{.name = "type", .kind = kText, .required = true, .about = "What it is."},
    Key{.name = "priority",
        .kind = kInteger,
        .range = {.min = -1000, .max = 1000},
        .default_text = "0",
        .about = "Priority, against other clients, of its targets for motors and of what it sends to other "
                 "modules."}};

/// The tables of one type of module, made of its keys.
class TypeTables {
 public:
  explicit TypeTables(const ModuleType& type) : type_name_(type.name()) {
    Tables& own = tables_.emplace_back();
    own.name = "module_" + std::string{type.name()};
    for (Key key : kCommonKeys) {
      if (key.name == "type") key.words = {&type_name_, 1};
      own.keys.push_back(key);
    }
    for (const OwnKey& key : type.keys()) own.keys.push_back(convert(key, own.name));
    own.section = Section{own.name, own.keys, type.about()};
  }
  TypeTables(const TypeTables&) = delete;
  TypeTables& operator=(const TypeTables&) = delete;
  ~TypeTables() = default;

  [[nodiscard]] std::string_view typeName() const noexcept { return type_name_; }
  [[nodiscard]] const Section& section() const noexcept { return tables_.front().section; }

 private:
  struct Tables {
    std::string name;
    std::vector<Key> keys;
    Section section;
  };

  [[nodiscard]] Key convert(const OwnKey& key, const std::string& where) {
    Key made{.name = key.name,
             .unit = key.unit,
             .range = {.min = key.min, .max = key.max, .above_min = key.above_min},
             .words = key.choices,
             .required = key.required,
             .default_text = key.default_text,
             .about = key.about};
    switch (key.kind) {
      case OwnKey::Kind::kNumber: made.kind = kNumber; break;
      case OwnKey::Kind::kInteger: made.kind = kInteger; break;
      case OwnKey::Kind::kFlag: made.kind = kBoolean; break;
      case OwnKey::Kind::kChoice: break;
      case OwnKey::Kind::kMotor: made.form = &kMotorName; break;
      case OwnKey::Kind::kText: made.form = &formOf(key); break;
      case OwnKey::Kind::kSection:
      case OwnKey::Kind::kRows:
        made.kind = key.kind == OwnKey::Kind::kRows ? kSectionList : kSection;
        made.section = &nested(key, where);
        break;
    }
    return made;
  }

  [[nodiscard]] const TextForm& formOf(const OwnKey& key) {
    if (key.pattern.empty()) return kAnyText;
    if (!key.words.empty()) return forms_.emplace_back(TextForm{key.pattern, key.words});
    return forms_.emplace_back(
        TextForm{key.pattern, words_.emplace_back("a text of the form " + std::string{key.pattern})});
  }

  [[nodiscard]] const Section& nested(const OwnKey& key, const std::string& where) {
    Tables& inner = tables_.emplace_back();
    inner.name = where + "_" + std::string{key.name};
    for (const OwnKey& own : key.keys) inner.keys.push_back(convert(own, inner.name));
    inner.section = Section{inner.name, inner.keys, key.about};
    return inner.section;
  }

  std::string_view type_name_;
  std::deque<Tables> tables_;  // they point into each other
  std::deque<TextForm> forms_;
  std::deque<std::string> words_;
};

bool module_keys_made = false;

[[nodiscard]] const std::deque<TypeTables>& tables() {
  static const std::deque<TypeTables> kAll = [] {
    std::deque<TypeTables> all;
    for (const ModuleType* type : moduleTypes()) all.emplace_back(*type);
    return all;
  }();
  module_keys_made = true;
  return kAll;
}

[[nodiscard]] std::vector<std::string_view> typeNames() {
  std::vector<std::string_view> names;
  for (const auto& type : tables()) names.push_back(type.typeName());
  return names;
}

[[nodiscard]] const Section* findSection(std::string_view name) {
  for (const auto& type : tables()) {
    if (type.typeName() == name) return &type.section();
  }
  return nullptr;
}

}  // namespace

bool isCommonModuleKey(std::string_view name) {
  return std::any_of(kCommonKeys.begin(), kCommonKeys.end(),
                     [name](const Key& key) { return key.name == name; });
}

bool moduleKeysMade() noexcept { return module_keys_made; }

constexpr SectionTypes kModuleSections{typeNames, findSection};

}  // namespace rc10
