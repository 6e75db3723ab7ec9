#include "config/report/robot_json.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace rc10 {

using Json = nlohmann::ordered_json;

Json problemsJson(const std::vector<ConfigProblem>& problems) {
  Json list = Json::array();
  for (const auto& problem : problems) {
    list.push_back({{"file", problem.file},
                    {"line", problem.place.line},
                    {"column", problem.place.column},
                    {"path", problem.path},
                    {"text", problem.text}});
  }
  return list;
}

Json motorsJson(const BusConfig& bus, int rate_hz, Json (*motor_json)(const MotorConfig&, const BusLoad&)) {
  const auto loads = predictLoadByMotor(bus, rate_hz);
  Json motors = Json::array();
  for (std::size_t i = 0; i < bus.motors.size(); ++i) motors.push_back(motor_json(bus.motors[i], loads[i]));
  return motors;
}

Json groupsJson(const RobotConfig& config) {
  std::vector<std::string_view> names;
  for (const auto& bus : config.buses) {
    for (const auto& motor : bus.motors) names.push_back(motor.name());
  }
  Json groups = Json::array();
  for (const auto& group : config.groups) {
    Json members = Json::array();
    for (const auto motor : group.motors) members.push_back(names[motor]);
    groups.push_back({{"name", group.name},
                      {"motors", std::move(members)},
                      {"rearms_at_rest", group.on_return == GroupConfig::Return::kRearmAtRest},
                      {"together", group.together},
                      {"implied", group.implied}});
  }
  return groups;
}

}  // namespace rc10
