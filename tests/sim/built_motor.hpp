#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bus/fdcan_bus.hpp"
#include "drives/families.hpp"
#include "motor/solo_motor.hpp"
#include "sim/drive.hpp"
#include "support/family_of.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test {

using OwnKeys = std::vector<std::pair<std::string, OwnValues::Value>>;

/// A motor that its family built, as the daemon does, and its simulated drive.
class BuiltMotor {
 public:
  BuiltMotor(const char* model, int id, const OwnKeys& own)
      : entry_(familyOf(model)), settings_(defaultSettings(*entry_.family, model, id)) {
    settings_.zero_at_power_on = true;
    for (const auto& [key, value] : own) settings_.own.set(key, value);
  }

  [[nodiscard]] MotorSettings& settings() { return settings_; }
  [[nodiscard]] MotorTraits traits() const { return entry_.family->traits(settings_.model, settings_.own); }
  std::unique_ptr<SoloMotor> motor() {
    auto built = entry_.family->build(settings_, parts_);
    if (!built) throw std::invalid_argument(built.error().message);
    return std::unique_ptr<SoloMotor>(dynamic_cast<SoloMotor*>(built->release()));
  }
  std::unique_ptr<sim::Drive> drive() { return entry_.simulate(settings_, {}); }

 private:
  const FamilyEntry& entry_;
  MotorSettings settings_;
  std::unique_ptr<fdCANbus> bus_ = fdCANbus::adopt("can0", UniqueFd{}, true);
  BusParts parts_{*bus_};
};

}  // namespace rc10::test
