#include "config/keys/settings.hpp"

#include <algorithm>
#include <limits>

#include "config/yaml/number_text.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

std::optional<GivenValue> Settings::find(std::string_view key) const {
  for (const auto& layer : layers_) {
    const YamlNode* node = layer.map->find(key);
    if (node == nullptr) continue;
    if (node->refused) return std::nullopt;
    return GivenValue{node, joinPath(layer.path, key)};
  }
  return std::nullopt;
}

bool Settings::mentions(std::string_view key) const noexcept {
  return std::any_of(layers_.begin(), layers_.end(),
                     [key](const Layer& layer) { return layer.map->find(key) != nullptr; });
}

Settings Settings::section(std::string_view key) const {
  std::vector<Layer> inner;
  for (const auto& layer : layers_) {
    const YamlNode* node = layer.map->find(key);
    if (node != nullptr && !node->refused) inner.push_back({node, joinPath(layer.path, key)});
  }
  return Settings{std::move(inner)};
}

std::string Settings::text(std::string_view key) const {
  const auto given = find(key);
  return given ? given->text() : std::string{};
}

std::optional<double> Settings::number(std::string_view key) const {
  const auto given = find(key);
  if (!given) return std::nullopt;
  const auto value = parseNumber(given->text());
  return value ? std::optional{*value} : std::nullopt;
}

void Settings::read(std::string_view key, std::string& value) const {
  if (const auto given = find(key)) value = given->text();
}

void Settings::read(std::string_view key, bool& value) const {
  if (const auto given = find(key)) value = given->text() == "true";
}

void Settings::read(std::string_view key, int& value) const {
  constexpr double kBound = std::numeric_limits<int>::max();
  if (const auto given = number(key)) value = static_cast<int>(std::clamp(*given, -kBound, kBound));
}

void Settings::read(std::string_view key, std::uint64_t& value) const {
  if (const auto given = number(key)) value = static_cast<std::uint64_t>(*given);
}

void Settings::read(std::string_view key, float& value) const {
  if (const auto given = number(key)) value = static_cast<float>(*given);
}

void Settings::read(std::string_view key, double& value) const { value = number(key).value_or(value); }

}  // namespace rc10
