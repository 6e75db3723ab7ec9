#include "config/build/implied_groups.hpp"

#include <algorithm>
#include <set>

#include "config/module_motors.hpp"

namespace rc10 {
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
    const auto motors = motorsNamedBy(module);
    std::copy_if(motors.begin(), motors.end(), std::back_inserter(group.motors),
                 [&taken](std::size_t motor) { return taken.insert(motor).second; });
    std::sort(group.motors.begin(), group.motors.end());
    if (group.motors.size() > 1) robot.groups.push_back(std::move(group));
  }
}

}  // namespace rc10
