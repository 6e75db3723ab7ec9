#include "config/keys/value_check.hpp"

#include <regex.h>

#include <algorithm>
#include <cmath>

#include "app/nearest.hpp"
#include "config/yaml/number_text.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {
namespace {

std::string inUnit(std::string_view unit) { return unit.empty() ? "" : " " + std::string{unit}; }

/// Empty if the text is one of the key's choices.
std::string whyNoChoice(const YamlNode& node, const Key& key) {
  const auto choices = key.allChoices();
  const bool known = std::find(choices.begin(), choices.end(), node.text) != choices.end();
  return known ? "" : notOneOf(node.text, choices);
}

std::string whyNoNumber(const YamlNode& node, const Key& key) {
  if (node.in_quotes) return inQuotes(node.text) + " is a text because of its quotes; remove them";
  if (key.hasChoices()) return whyNoChoice(node, key);
  if (key.kind == ValueKind::kInteger) {
    const auto value = parseInteger(node.text);
    return value ? whyOutOfRange(static_cast<double>(*value), key) : value.error().message;
  }
  const auto value = parseNumber(node.text);
  return value ? whyOutOfRange(*value, key) : value.error().message;
}

std::string whyNoBoolean(const YamlNode& node) {
  if (node.in_quotes) return inQuotes(node.text) + " is a text because of its quotes; remove them";
  if (node.text == "true" || node.text == "false") return "";
  return inQuotes(node.text) + " is not true or false; write one of these";
}

}  // namespace

std::string whyOutOfRange(double value, const Key& key) {
  const Range& range = key.range;
  const std::string fix = "; " + useWords(range, key.unit);
  // As a float, which is what it becomes: a limit of 1e-60 would be 0, and 0 is "no limit" further down.
  const bool at_min = static_cast<float>(value) == static_cast<float>(range.min);
  if (range.above_min && at_min) return numberText(value) + " is not accepted" + fix;
  if (value < range.min)
    return numberText(value) + " is below " + numberText(range.min) + inUnit(key.unit) + fix;
  if (value > range.max)
    return numberText(value) + " is above " + numberText(range.max) + inUnit(key.unit) + fix;
  return "";
}

std::string whyNoText(const YamlNode& node, const Key& key) {
  if (key.hasChoices()) return whyNoChoice(node, key);
  return matches(node.text, *key.form)
             ? ""
             : inQuotes(node.text) + " is not accepted; use " + std::string{key.form->words};
}

bool matches(std::string_view text, const TextForm& form) {
  constexpr std::size_t kLongestValue = 128;
  if (text.size() > kLongestValue || text.find('\0') != std::string_view::npos) return false;
  // POSIX: std::regex recurses once a character, throws, and costs ten times as much.
  regex_t regex{};
  if (regcomp(&regex, ("^(" + std::string{form.pattern} + ")$").c_str(), REG_EXTENDED | REG_NOSUB) != 0)
    return false;
  const bool found = regexec(&regex, std::string{text}.c_str(), 0, nullptr, 0) == 0;
  regfree(&regex);
  return found;
}

std::string whyNoValue(const YamlNode& node, const Key& key) {
  switch (key.kind) {
    case ValueKind::kText: return whyNoText(node, key);
    case ValueKind::kInteger:
    case ValueKind::kNumber: return whyNoNumber(node, key);
    case ValueKind::kBoolean: return whyNoBoolean(node);
    case ValueKind::kTextList:
    case ValueKind::kSection:
    case ValueKind::kSectionList:
    case ValueKind::kNamedSections:
    case ValueKind::kTypedSections: break;
  }
  return "";
}

std::string wantedWords(const Key& key) {
  if (key.hasChoices()) {
    const auto choices = key.allChoices();
    return listWords({choices.begin(), choices.end()}, " or ");
  }
  switch (key.kind) {
    case ValueKind::kText: return "a text";
    case ValueKind::kInteger:
      return "a whole number" + (key.unit.empty() ? "" : " in " + std::string{key.unit});
    case ValueKind::kNumber: return "a number" + (key.unit.empty() ? "" : " in " + std::string{key.unit});
    case ValueKind::kBoolean: return "true or false";
    case ValueKind::kTextList: return "a list of texts";
    case ValueKind::kSection: return "a map of keys";
    case ValueKind::kSectionList: return "a list, each item a map of keys";
    case ValueKind::kNamedSections: return "a map from names to maps of keys";
    case ValueKind::kTypedSections: return "a list, each item a map of keys with a type";
  }
  return "";
}

std::string useWords(const Range& range, std::string_view unit) {
  const bool open = std::isinf(range.max);
  std::string words = range.above_min ? "use more than " : open ? "use at least " : "use ";
  words += numberText(range.min);
  if (!open) words += (range.above_min ? ", at most " : " to ") + numberText(range.max);
  return words + inUnit(unit);
}

std::string notOneOf(std::string_view text, const std::vector<std::string_view>& choices) {
  const std::vector<std::string> words{choices.begin(), choices.end()};
  const bool is_word = text.size() > 1 && !parseNumber(text);
  const auto meant = is_word ? didYouMean(text, choices) : std::string{};
  return inQuotes(text) + " is not one of " + listWords(words) +
         (meant.empty() ? "; use one of these" : meant);
}

}  // namespace rc10
