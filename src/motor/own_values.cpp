#include "motor/own_values.hpp"

#include <algorithm>

namespace rc10 {

void OwnValues::set(std::string_view key, Value value) {
  const auto found =
      std::find_if(values_.begin(), values_.end(), [key](const auto& entry) { return entry.first == key; });
  if (found != values_.end()) {
    found->second = std::move(value);
  } else {
    values_.emplace_back(key, std::move(value));
  }
}

const OwnValues::Value* OwnValues::find(std::string_view key) const {
  const auto found =
      std::find_if(values_.begin(), values_.end(), [key](const auto& entry) { return entry.first == key; });
  return found != values_.end() ? &found->second : nullptr;
}

double OwnValues::number(std::string_view key) const {
  const auto* value = find(key);
  const auto* number = value != nullptr ? std::get_if<double>(value) : nullptr;
  return number != nullptr ? *number : 0.0;
}

std::string OwnValues::text(std::string_view key) const {
  const auto* value = find(key);
  const auto* text = value != nullptr ? std::get_if<std::string>(value) : nullptr;
  return text != nullptr ? *text : std::string{};
}

const std::vector<OwnValues>& OwnValues::rows(std::string_view key) const {
  static const std::vector<OwnValues> kNone;
  const auto* value = find(key);
  const auto* rows = value != nullptr ? std::get_if<std::vector<OwnValues>>(value) : nullptr;
  return rows != nullptr ? *rows : kNone;
}

const OwnValues& OwnValues::section(std::string_view key) const {
  static const OwnValues kEmpty;
  const auto& all = rows(key);
  return all.empty() ? kEmpty : all.front();
}

}  // namespace rc10
