#include "config/module_types.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "config/keys/module_keys.hpp"
#include "module/chassis.hpp"
#include "module/feeder.hpp"
#include "module/gimbal.hpp"
#include "module/gpio_module.hpp"
#include "module/imu.hpp"
#include "module/joint.hpp"
#include "module/led_strip.hpp"
#include "module/rangefinder.hpp"
#include "module/remote.hpp"
#include "module/serial_link.hpp"
#include "module/swerve_chassis.hpp"
#include "module/synchronised_pair.hpp"

namespace rc10 {
namespace {

/// The types of rc10d: the one place where a new one is entered.
[[nodiscard]] std::vector<const ModuleType*>& types() {
  static std::vector<const ModuleType*> all{
      &mecanumChassisType(),   &omni3ChassisType(), &omni4ChassisType(), &differentialChassisType(),
      &swerveChassisType(),    &gimbalType(),       &feederType(),       &jointType(),
      &synchronisedPairType(), &remoteType(),       &imuType(),          &rangefinderType(),
      &gpioModuleType(),       &ledStripType(),     &serialLinkType(),
  };
  return all;
}

}  // namespace

std::span<const ModuleType* const> moduleTypes() { return types(); }

Result<void> addModuleType(const ModuleType& type) {
  const std::string who = "module type '" + std::string{type.name()} + "': ";
  if (moduleKeysMade()) return fail(who + "a configuration has been read already; add types before that");
  if (findModuleType(type.name()) != nullptr) return fail(who + "there is one of that name; give it another");
  for (const OwnKey& key : type.keys()) {
    if (isCommonModuleKey(key.name)) {
      return fail(who + "every module has a key '" + std::string{key.name} + "'; give it another name");
    }
  }
  types().push_back(&type);
  return {};
}

const ModuleType* findModuleType(std::string_view name) {
  const auto& all = types();
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const ModuleType* type) { return type->name() == name; });
  return found != all.end() ? *found : nullptr;
}

}  // namespace rc10
