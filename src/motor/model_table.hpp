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
template <typename Model, std::size_t kCount>
[[nodiscard]] constexpr std::array<std::string_view, kCount> modelNames(
    const std::array<Model, kCount>& models) noexcept {
  std::array<std::string_view, kCount> names{};
  for (std::size_t i = 0; i < kCount; ++i) names[i] = models[i].name;
  return names;
}

}  // namespace rc10
