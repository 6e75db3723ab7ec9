#pragma once

#include <memory>
#include <string>
#include <utility>

#include "drives/cubemars/cubemars_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/cubemars_settings.hpp"

namespace rc10::test {

inline std::unique_ptr<SoloMotor> motorOf(const MotorSettings& settings) {
  const auto setup = setupOf(settings);
  if (setup.protocol == CubemarsProtocol::kServo) return std::make_unique<CubemarsServo>(settings, setup);
  return std::make_unique<CubemarsMit>(settings, setup);
}

inline SoloRig rigOf(const MotorSettings& settings, const sim::MotorLoad& load = {}) {
  return SoloRig{motorOf(settings), sim::makeCubemarsDrive(settings, load)};
}

struct CubemarsCase {
  const char* model;
  const char* protocol;
  double gear_ratio = 0.0;
  int direction = 1;
};

inline MotorSettings settingsOf(const CubemarsCase& each, OwnKeys keys = {}) {
  keys.emplace_back("protocol", std::string{each.protocol});
  auto settings = cubemarsSettings(each.model, 12, keys);
  settings.gear_ratio = each.gear_ratio;
  settings.direction = each.direction;
  settings.zero_at_power_on = true;
  return settings;
}

}  // namespace rc10::test
