#pragma once

#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drives/cubemars/cubemars_family.hpp"
#include "drives/cubemars/cubemars_mit.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "drives/cubemars/cubemars_servo.hpp"

namespace rc10::test {

using OwnKeys = std::vector<std::pair<std::string, OwnValues::Value>>;

/// A motor as configured, all own keys at their defaults but these.
inline MotorSettings cubemarsSettings(std::string_view model, int id, const OwnKeys& keys = {}) {
  MotorSettings settings;
  settings.name = "joint";
  settings.model = model;
  settings.id = id;
  for (const auto& key : cubemarsFamily().keys()) {
    const std::string text{key.default_text};
    if (key.kind == OwnKey::Kind::kChoice) {
      settings.own.set(key.name, text);
    } else if (key.kind == OwnKey::Kind::kFlag) {
      settings.own.set(key.name, text == "true" ? 1.0 : 0.0);
    } else {
      settings.own.set(key.name, std::strtod(text.c_str(), nullptr));
    }
  }
  for (const auto& [name, value] : keys) settings.own.set(name, value);
  return settings;
}

inline CubemarsSettings setupOf(const MotorSettings& settings) {
  return cubemarsSettings(settings.model, settings.own);
}

}  // namespace rc10::test
