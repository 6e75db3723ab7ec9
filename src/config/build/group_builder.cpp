#include "config/build/group_builder.hpp"

#include <map>
#include <optional>
#include <string>

#include "config/build/motor_names.hpp"
#include "config/keys/unique_names.hpp"

namespace rc10 {
namespace {

class GroupBuilder {
 public:
  GroupBuilder(const std::vector<BusConfig>& buses, Problems& problems)
      : problems_(problems), motor_names_(buses) {}

  GroupConfig build(const YamlNode& node, const std::string& path) {
    const Settings settings{{{&node, path}}};
    GroupConfig group;
    group.place = node.place;
    settings.read("name", group.name);
    if (const auto name = settings.find("name")) group_names_.add(*name, problems_);
    if (settings.text("on_return") == "rearm_at_rest") group.on_return = GroupConfig::Return::kRearmAtRest;
    settings.read("together", group.together);
    const auto motors = settings.find("motors");
    for (std::size_t i = 0; motors && i < motors->node->items.size(); ++i) {
      const YamlNode& item = motors->node->items[i];
      if (item.refused) continue;
      if (const auto motor = member({&item, joinPath(motors->path, i)})) group.motors.push_back(*motor);
    }
    return group;
  }

 private:
  std::optional<std::size_t> member(const GivenValue& given) {
    const auto motor = motor_names_.find(given, problems_);
    if (!motor) return std::nullopt;
    const auto [first, is_new] = members_.emplace(*motor, given.path);
    if (is_new) return motor;
    problems_.error(given.place(), given.path,
                    inQuotes(given.text()) + " is in a group already, at " + first->second +
                        "; a motor is in one group at most");
    return std::nullopt;
  }

  Problems& problems_;
  MotorNames motor_names_;
  std::map<std::size_t, std::string> members_;
  UniqueNames group_names_{"group name", "the robot"};
};

}  // namespace

std::vector<GroupConfig> buildGroups(const Settings& robot, const std::vector<BusConfig>& buses,
                                     Problems& problems) {
  std::vector<GroupConfig> groups;
  const auto given = robot.find("groups");
  if (!given) return groups;
  GroupBuilder builder{buses, problems};
  for (std::size_t i = 0; i < given->node->items.size(); ++i) {
    const YamlNode& node = given->node->items[i];
    if (!node.refused) groups.push_back(builder.build(node, joinPath(given->path, i)));
  }
  return groups;
}

}  // namespace rc10
