#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace rc10 {

/// Row of a family's table of models with this name; nullptr: none.
template <typename Models>
[[nodiscard]] constexpr auto* findModel(const Models& models, std::string_view name) noexcept {
  for (const auto& model : models) {
    if (model.name == name) return &model;
  }
  return static_cast<decltype(&models[0])>(nullptr);
}

/// Names of all rows, as MotorFamily::models() gives them.
template <typename Model, std::size_t Count>
[[nodiscard]] constexpr std::array<std::string_view, Count> modelNames(
    const std::array<Model, Count>& models) noexcept {
  std::array<std::string_view, Count> names{};
  for (std::size_t i = 0; i < Count; ++i) names[i] = models[i].name;
  return names;
}

}  // namespace rc10
