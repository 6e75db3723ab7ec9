#include "config/build/family_keys.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/keys/value_check.hpp"
#include "config/motor_families.hpp"
#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

/// Families share the names of keys, not always their ranges.
bool ownRange(MotorParse& in, const OwnKey& key, const GivenValue& given) {
  if (key.kind == OwnKey::Kind::kChoice) {
    if (std::find(key.choices.begin(), key.choices.end(), given.text()) != key.choices.end()) return true;
    const std::vector<std::string> words{key.choices.begin(), key.choices.end()};
    in.problems.error(given.place(), given.path,
                      inQuotes(given.text()) + " is nothing that the " + in.modelName() + " knows; use " +
                          listWords(words, " or "));
    return false;
  }
  if (key.kind == OwnKey::Kind::kFlag) return true;
  const double value = in.motor().own.number(key.name);
  if (value <= key.max && (key.above_min ? value > key.min : value >= key.min)) return true;
  const Range range{.min = key.min, .max = key.max, .above_min = key.above_min};
  in.problems.error(
      given.place(), given.path,
      given.text() + " is outside what the " + in.modelName() + " takes; " + useWords(range, key.unit));
  return false;
}

bool readOwnKey(MotorParse& in, const OwnKey& key) {
  const auto given = in.settings.find(key.name);
  if (!given && in.settings.mentions(key.name)) return false;  // refused already
  if (!given && key.required) {
    in.problems.error(in.draft.config.place, joinPath(in.draft.path, key.name),
                      "is missing for the " + in.modelName() + "; add it: " + std::string{key.about});
    return false;
  }
  const std::string text = given ? given->text() : std::string{key.default_text};
  if (key.kind == OwnKey::Kind::kChoice) {
    in.motor().own.set(key.name, text);
  } else if (key.kind == OwnKey::Kind::kFlag) {
    in.motor().own.set(key.name, text == "true" ? 1.0 : 0.0);
  } else {
    const auto value = parseNumber(text);
    in.motor().own.set(key.name, value ? *value : 0.0);
  }
  return !given || ownRange(in, key, *given);
}

void refuseForeignKey(MotorParse& in, const OwnKey& key, const MotorFamily& other,
                      std::set<std::string_view>& refused) {
  const auto own = in.draft.config.family->keys();
  const bool known =
      std::any_of(own.begin(), own.end(), [&](const OwnKey& mine) { return mine.name == key.name; });
  const auto given = known ? std::nullopt : in.settings.find(key.name);
  if (!given || !refused.insert(key.name).second) return;
  in.problems.error(given->place(), given->path,
                    "means nothing for the " + in.modelName() + "; it belongs to " +
                        std::string{other.name()} + ". Remove it");
}

}  // namespace

bool readOwnKeys(MotorParse& in) {
  bool complete = true;
  std::set<std::string_view> refused;
  for (const OwnKey& key : in.draft.config.family->keys()) complete &= readOwnKey(in, key);
  for (const auto& other : motorFamilies()) {
    for (const OwnKey& key : other.family->keys()) refuseForeignKey(in, key, *other.family, refused);
  }
  return complete;
}

bool checkOwnKeys(MotorParse& in) {
  in.settings.read(in.effortKey(), in.motor().effort_limit);
  in.settings.read("velocity_limit_rpm", in.motor().velocity_limit_rpm);
  in.settings.read("command_divider", in.motor().command_divider);
  const auto good = in.draft.config.family->check(in.motor());
  if (good) return true;
  const std::string& message = good.error().message;
  const auto colon = message.find(": ");
  const auto key = colon != std::string::npos ? message.substr(0, colon) : std::string{};
  if (const auto given = key.empty() ? std::nullopt : in.settings.find(key)) {
    in.problems.error(given->place(), given->path, message.substr(colon + 2));
  } else {
    in.problems.error(in.draft.config.place, in.draft.path, message);
  }
  return false;
}

}  // namespace rc10
