#pragma once

#include <string>
#include <string_view>

#include "drives/robstride/robstride_family.hpp"
#include "drives/robstride/robstride_motor.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test {

/// A motor as the configuration makes it: the family's own keys at their defaults.
inline MotorSettings robStrideSettings(std::string_view model, int id = 127) {
  MotorSettings settings;
  settings.name = "joint";
  settings.model = std::string{model};
  settings.id = id;
  settings.own = ownDefaults(robstrideFamily());
  return settings;
}

}  // namespace rc10::test
