#include "config/build/client_builder.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/nearest.hpp"
#include "config/build/motor_names.hpp"

namespace rc10 {
namespace {

class ClientBuilder {
 public:
  ClientBuilder(const RobotConfig& robot, Problems& problems)
      : robot_(robot), problems_(problems), motor_names_(robot.buses) {}

  ClientConfig build(const YamlNode& node, const std::string& path) {
    const Settings settings{{{&node, path}}};
    ClientConfig client;
    client.line = node.place.line;
    readWho(settings, node, path, client);
    readRights(settings, client);
    const bool any = !settings.mentions("motors") && !settings.mentions("modules");
    client.all_motors = client.all_modules = any;
    eachOf(settings, "motors", [&](const GivenValue& given) {
      if (const auto motor = motor_names_.find(given, problems_)) client.motors.push_back(*motor);
    });
    eachOf(settings, "modules", [&](const GivenValue& given) {
      if (const auto module = findModule(given)) client.modules.push_back(*module);
    });
    settings.read("max_priority", client.max_priority);
    return client;
  }

 private:
  void readWho(const Settings& settings, const YamlNode& node, const std::string& path,
               ClientConfig& client) {
    int given = 0;
    constexpr std::array<std::pair<std::string_view, ClientConfig::By>, 4> kWays{
        {{"lcm", ClientConfig::By::kLcmName},
         {"user", ClientConfig::By::kUser},
         {"group", ClientConfig::By::kGroup},
         {"token", ClientConfig::By::kToken}}};
    for (const auto& [key, by] : kWays) {
      if (settings.mentions(key)) ++given;
      const auto who = settings.find(key);
      if (!who) continue;
      client.by = by;
      client.who = who->text();
      if (by == ClientConfig::By::kLcmName) checkLcmName(*who);
    }
    if (given == 1) return;
    problems_.error(node.place, path,
                    given == 0 ? "says not whose rights these are; add one of lcm, user, group and token"
                               : "says twice whose rights these are; keep one of lcm, user, group and token, "
                                 "and make an entry for each other");
  }

  void checkLcmName(const GivenValue& who) {
    const bool of_module =
        std::any_of(robot_.modules.begin(), robot_.modules.end(),
                    [&](const ModuleConfig& module) { return module.settings.name == who.text(); });
    if (of_module) {
      problems_.error(who.place(), who.path,
                      inQuotes(who.text()) +
                          " is a module, whose name no client may use; give the program "
                          "another name");
    } else if (!robot_.lcm.enabled) {
      problems_.warning(who.place(), who.path, "nothing comes by LCM: lcm.enabled is false");
    }
  }

  void readRights(const Settings& settings, ClientConfig& client) {
    eachOf(settings, "may", [&](const GivenValue& given) {
      const auto right = std::find(kRightWords.begin(), kRightWords.end(), given.text());
      if (right != kRightWords.end())
        client.rights[static_cast<std::size_t>(right - kRightWords.begin())] = true;
    });
  }

  template <typename Work>
  void eachOf(const Settings& settings, std::string_view key, Work work) {
    const auto list = settings.find(key);
    for (std::size_t i = 0; list && i < list->node->items.size(); ++i) {
      const YamlNode& item = list->node->items[i];
      if (!item.refused) work(GivenValue{&item, joinPath(list->path, i)});
    }
  }

  std::optional<std::size_t> findModule(const GivenValue& given) {
    std::vector<std::string_view> names;
    names.reserve(robot_.modules.size());
    for (const auto& module : robot_.modules) names.emplace_back(module.settings.name);
    const auto found = std::find(names.begin(), names.end(), given.text());
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const auto meant = nearest(given.text(), names);
    problems_.error(
        given.place(), given.path,
        "there is no module " + inQuotes(given.text()) +
            (meant.empty() ? "; name one of modules" : "; did you mean " + std::string{meant} + "?"));
    return std::nullopt;
  }

  const RobotConfig& robot_;
  Problems& problems_;
  MotorNames motor_names_;
};

// Line of the key itself: its list begins in the next line.
int lineOfKey(const Settings& top, std::string_view key, int otherwise) {
  for (const auto& layer : top.layers()) {
    for (const auto& entry : layer.map->entries)
      if (entry.key.text == key) return entry.key.place.line;
  }
  return otherwise;
}

}  // namespace

void buildClients(const Settings& top, RobotConfig& robot, Problems& problems) {
  if (const auto tuning = top.find("tuning"); tuning && tuning->text() == "locked")
    robot.tuning_locked_at = tuning->place().line;
  if (const auto clear = top.find("clear"); clear && clear->text() == "local")
    robot.clear_local_at = clear->place().line;
  const auto given = top.find("clients");
  if (!given) return;
  robot.clients.emplace();
  robot.clients->line = lineOfKey(top, "clients", given->place().line);
  ClientBuilder builder{robot, problems};
  for (std::size_t i = 0; i < given->node->items.size(); ++i) {
    const YamlNode& node = given->node->items[i];
    if (!node.refused) robot.clients->entries.push_back(builder.build(node, joinPath(given->path, i)));
  }
}

}  // namespace rc10
