#include "config/build/implied_groups.hpp"

#include <algorithm>
#include <set>

namespace rc10 {
namespace {

void collectMotors(const OwnValues& own, std::span<const OwnKey> keys, std::vector<std::size_t>& motors) {
  for (const OwnKey& key : keys) {
    const bool nested = key.kind == OwnKey::Kind::kSection || key.kind == OwnKey::Kind::kRows;
    if (!own.given(key.name)) continue;
    if (key.kind == OwnKey::Kind::kMotor) motors.push_back(own.motor(key.name));
    if (!nested) continue;
    for (const OwnValues& row : own.rows(key.name)) collectMotors(row, key.keys, motors);
  }
}

}  // namespace

void addImpliedGroups(RobotConfig& robot) {
  std::set<std::size_t> taken;
  for (const auto& group : robot.groups) taken.insert(group.motors.begin(), group.motors.end());
  for (const auto& module : robot.modules) {
    if (module.type == nullptr || module.type->coupling() == ModuleType::Coupling::kNone) continue;
    GroupConfig group;
    group.place = module.place;
    group.name = module.settings.name;
    group.on_return = GroupConfig::Return::kRearmAtRest;
    group.together = module.type->coupling() == ModuleType::Coupling::kTogether;
    group.implied = true;
    std::vector<std::size_t> motors;
    collectMotors(module.settings.own, module.type->keys(), motors);
    std::copy_if(motors.begin(), motors.end(), std::back_inserter(group.motors),
                 [&taken](std::size_t motor) { return taken.insert(motor).second; });
    std::sort(group.motors.begin(), group.motors.end());
    if (group.motors.size() > 1) robot.groups.push_back(std::move(group));
  }
}

}  // namespace rc10
