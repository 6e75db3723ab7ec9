#include "config/build/implied_groups.hpp"

#include <algorithm>
#include <vector>

#include "config/module_motors.hpp"

namespace rc10 {
namespace {

/// The group that a motor is in; nullptr: none.
const GroupConfig* groupOf(const RobotConfig& robot, std::size_t motor) {
  const auto found =
      std::find_if(robot.groups.begin(), robot.groups.end(), [motor](const GroupConfig& group) {
        return std::find(group.motors.begin(), group.motors.end(), motor) != group.motors.end();
      });
  return found == robot.groups.end() ? nullptr : &*found;
}

std::string inGroup(const GroupConfig& group) {
  return std::string{"group "} + group.name + (group.implied ? " of the module of that name" : "");
}

/// A load that two motors lift racks where only one of them stops.
void checkGroup(const RobotConfig& robot, const ModuleConfig& module, const std::vector<std::size_t>& motors,
                Problems& problems) {
  const bool together = module.type->coupling() == ModuleType::Coupling::kTogether;
  const auto* first = groupOf(robot, motors.front());
  const bool in_one = std::all_of(motors.begin(), motors.end(),
                                  [&](std::size_t motor) { return groupOf(robot, motor) == first; });
  if (in_one) {
    if (together && !first->together)
      problems.warning(module.place, module.path,
                       "its motors are one mechanism, and " + inGroup(*first) +
                           " enables them one by one; give it together: true");
    return;
  }
  const auto apart = std::find_if(motors.begin(), motors.end(),
                                  [&robot](std::size_t motor) { return groupOf(robot, motor) != nullptr; });
  const auto text = inGroup(*groupOf(robot, *apart)) + " has only some of its motors, so that the others " +
                    "do not stop with them; put all of them into it, or none";
  if (together) {
    problems.error(module.place, module.path, text);
  } else {
    problems.warning(module.place, module.path, text);
  }
}

}  // namespace

void addImpliedGroups(RobotConfig& robot, Problems& problems) {
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
                 [&robot](std::size_t motor) { return groupOf(robot, motor) == nullptr; });
    std::sort(group.motors.begin(), group.motors.end());
    if (group.motors.size() < motors.size()) checkGroup(robot, module, motors, problems);
    if (group.motors.size() > 1) robot.groups.push_back(std::move(group));
  }
}

}  // namespace rc10
