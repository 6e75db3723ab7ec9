#pragma once

#include <cstdlib>
#include <string>
#include <string_view>

#include "motor/motor_family.hpp"

namespace rc10::test {

/// All of a family's own keys with their defaults, as the configuration fills them in.
inline OwnValues ownDefaults(const MotorFamily& family) {
  OwnValues own;
  for (const OwnKey& key : family.keys()) {
    const std::string text{key.default_text};
    if (key.kind == OwnKey::Kind::kChoice) {
      own.set(key.name, text);
    } else if (key.kind == OwnKey::Kind::kFlag) {
      own.set(key.name, text == "true" ? 1.0 : 0.0);
    } else {
      own.set(key.name, std::strtod(text.c_str(), nullptr));
    }
  }
  return own;
}

/// A motor of this model with all keys at their defaults.
inline MotorSettings defaultSettings(const MotorFamily& family, std::string_view model, int id) {
  MotorSettings settings;
  settings.name = "motor";
  settings.model = model;
  settings.id = id;
  settings.own = ownDefaults(family);
  return settings;
}

}  // namespace rc10::test
