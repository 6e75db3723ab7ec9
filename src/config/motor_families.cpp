#include "config/motor_families.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "config/motor_keys.hpp"
#include "motor/cubemars_family.hpp"
#include "motor/damiao_motor.hpp"
#include "motor/dji_family.hpp"
#include "motor/lktech_motor.hpp"
#include "motor/moteus_model.hpp"
#include "motor/myactuator_motor.hpp"
#include "motor/odrive_motor.hpp"
#include "motor/robstride_motor.hpp"
#include "motor/vesc_motor.hpp"
#include "sim/cubemars_drive.hpp"
#include "sim/damiao_drive.hpp"
#include "sim/dji_drive.hpp"
#include "sim/lktech_drive.hpp"
#include "sim/moteus_drive.hpp"
#include "sim/myactuator_drive.hpp"
#include "sim/odrive_drive.hpp"
#include "sim/robstride_drive.hpp"
#include "sim/vesc_drive.hpp"

namespace rc10 {
namespace {

/// The families of rc10d: the one place where a new one is entered.
[[nodiscard]] std::vector<FamilyEntry> builtIn() {
  return {
      {&djiFamily(), sim::makeDjiDrive},           {&vescFamily(), sim::makeVescDrive},
      {&damiaoFamily(), sim::makeDamiaoDrive},     {&robStrideFamily(), sim::makeRobStrideDrive},
      {&cubemarsFamily(), sim::makeCubemarsDrive}, {&moteusFamily(), sim::makeMoteusDrive},
      {&odriveFamily(), sim::makeOdriveDrive},     {&myactuatorFamily(), sim::makeMyactuatorDrive},
      {&lktechFamily(), sim::makeLktechDrive},
  };
}

[[nodiscard]] std::vector<FamilyEntry>& entries() {
  static std::vector<FamilyEntry> all = builtIn();
  return all;
}

}  // namespace

std::span<const FamilyEntry> motorFamilies() { return entries(); }

Result<void> addMotorFamily(const FamilyEntry& entry) {
  const std::string who = "motor family '" + std::string{entry.family->name()} + "': ";
  if (motorKeysMade()) return fail(who + "a configuration has been read already; add families before that");
  for (const auto model : entry.family->models()) {
    if (const auto* other = findFamily(model); other != nullptr) {
      return fail(who + "model " + std::string{model} + " is one of family '" +
                  std::string{other->family->name()} + "'; give it another name");
    }
  }
  for (const FamilyKey& key : entry.family->keys()) {
    if (isCommonMotorKey(key.name)) {
      return fail(who + "every motor has a key '" + std::string{key.name} + "'; give it another name");
    }
  }
  entries().push_back(entry);
  return {};
}

const FamilyEntry* findFamily(std::string_view model) {
  const auto& all = entries();
  const auto found = std::find_if(all.begin(), all.end(), [model](const FamilyEntry& entry) {
    const auto models = entry.family->models();
    return std::find(models.begin(), models.end(), model) != models.end();
  });
  return found != all.end() ? &*found : nullptr;
}

}  // namespace rc10
