#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drives/cubemars/cubemars_family.hpp"
#include "drives/cubemars/cubemars_mit.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "drives/cubemars/cubemars_servo.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test {

using OwnKeys = std::vector<std::pair<std::string, OwnValues::Value>>;

/// A motor as configured, all own keys at their defaults but these.
inline MotorSettings cubemarsSettings(std::string_view model, int id, const OwnKeys& keys = {}) {
  MotorSettings settings;
  settings.name = "joint";
  settings.model = model;
  settings.id = id;
  settings.own = ownDefaults(cubemarsFamily());
  for (const auto& [name, value] : keys) settings.own.set(name, value);
  return settings;
}

inline CubemarsSettings setupOf(const MotorSettings& settings) {
  return cubemarsSettings(settings.model, settings.own);
}

}  // namespace rc10::test
