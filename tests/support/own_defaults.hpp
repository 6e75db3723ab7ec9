#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// Values of choices and flags, one at a time, beside the defaults of the others.
[[nodiscard]] inline std::vector<MotorSettings> variants(const MotorFamily& family, std::string_view model,
                                                         int id) {
  std::vector<MotorSettings> all{defaultSettings(family, model, id)};
  all.front().effort_limit = 1.0F;
  all.front().velocity_limit_rpm = 100.0F;
  for (const OwnKey& key : family.keys()) {
    if (key.required) all.front().own.set(key.name, std::max(1.0, key.min));
    const auto with = [&](OwnValues::Value value) {
      all.push_back(all.front());
      all.back().own.set(key.name, std::move(value));
    };
    for (const auto choice : key.choices) with(std::string{choice});
    if (key.kind == OwnKey::Kind::kFlag) with(1.0);
  }
  std::erase_if(all, [&](const MotorSettings& settings) {
    return !family.check(settings) || id > family.traits(model, settings.own).max_id;
  });
  return all;
}

}  // namespace rc10::test
