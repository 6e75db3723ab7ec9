#pragma once

#include <string>
#include <string_view>

#include "drives/robstride/robstride_family.hpp"
#include "drives/robstride/robstride_motor.hpp"

namespace rc10::test {

/// A motor as the configuration makes it: the family's own keys at their defaults.
inline MotorSettings robStrideSettings(std::string_view model, int id = 127) {
  MotorSettings settings;
  settings.name = "joint";
  settings.model = std::string{model};
  settings.id = id;
  for (const auto& key : robstrideFamily().keys()) {
    if (key.kind == OwnKey::Kind::kChoice) {
      settings.own.set(key.name, std::string{key.default_text});
    } else {
      settings.own.set(key.name, std::stod(std::string{key.default_text}));
    }
  }
  return settings;
}

}  // namespace rc10::test
