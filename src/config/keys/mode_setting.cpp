#include "config/keys/mode_setting.hpp"

#include "config/motor_families.hpp"

namespace rc10 {

std::string settingForMode(std::string_view model, ControlMode mode) {
  const auto* entry = findFamily(model);
  if (entry == nullptr) return {};
  const auto& family = *entry->family;
  for (const OwnKey& chosen : family.keys()) {
    for (const auto choice : chosen.choices) {
      OwnValues own;
      for (const OwnKey& key : family.keys())
        own.set(key.name, std::string{&key == &chosen ? choice : key.default_text});
      if (family.traits(model, own).modes.contains(mode))
        return std::string{chosen.name} + ": " + std::string{choice};
    }
  }
  return {};
}

}  // namespace rc10
