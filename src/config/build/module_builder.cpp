#include "config/build/module_builder.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "config/build/motor_names.hpp"
#include "config/build/robot_outline.hpp"
#include "config/check/device_claims.hpp"
#include "config/keys/unique_names.hpp"
#include "config/module_types.hpp"
#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

/// The channels of the robot itself, beside which those of its modules stand.
constexpr std::array<std::string_view, 6> kRobotChannels{"command", "state",   "diagnostics",
                                                         "event",   "request", "response"};

class ModuleBuilder {
 public:
  ModuleBuilder(const std::vector<BusConfig>& buses, Problems& problems)
      : problems_(problems), motor_names_(buses) {}

  ModuleConfig build(const YamlNode& node, const std::string& path) {
    const Settings given{{{&node, path}}};
    ModuleConfig module;
    module.place = node.place;
    module.path = path;
    module.type = findModuleType(given.text("type"));
    given.read("name", module.settings.name);
    given.read("priority", module.settings.priority);
    if (const auto name = given.find("name")) checkName(*name);
    if (module.type != nullptr) module.settings.own = read(given, module.type->keys());
    return module;
  }

 private:
  void checkName(const GivenValue& name) {
    names_.add(name, problems_);
    if (std::find(kRobotChannels.begin(), kRobotChannels.end(), name.text()) == kRobotChannels.end()) return;
    problems_.error(
        name.place(), name.path,
        inQuotes(name.text()) + " is a channel of the robot itself; give the module another name");
  }

  OwnValues read(const Settings& given, std::span<const OwnKey> keys) {
    OwnValues values;
    for (const OwnKey& key : keys) {
      const auto written = given.find(key.name);
      const bool nested = key.kind == OwnKey::Kind::kSection || key.kind == OwnKey::Kind::kRows;
      if (nested) {
        if (written) values.set(key.name, readNested(*written, key));
      } else if (written) {
        setValue(values, key, written->text(), &*written);
      } else if (!key.default_text.empty()) {
        setValue(values, key, std::string{key.default_text}, nullptr);
      }
    }
    return values;
  }

  std::vector<OwnValues> readNested(const GivenValue& written, const OwnKey& key) {
    if (key.kind == OwnKey::Kind::kSection) return {read(Settings{{{written.node, written.path}}}, key.keys)};
    std::vector<OwnValues> rows;
    for (std::size_t i = 0; i < written.node->items.size(); ++i) {
      const YamlNode& item = written.node->items[i];
      if (!item.refused) rows.push_back(read(Settings{{{&item, joinPath(written.path, i)}}}, key.keys));
    }
    return rows;
  }

  void setValue(OwnValues& values, const OwnKey& key, const std::string& text, const GivenValue* written) {
    switch (key.kind) {
      case OwnKey::Kind::kFlag: return values.set(key.name, text == "true" ? 1.0 : 0.0);
      case OwnKey::Kind::kChoice:
      case OwnKey::Kind::kText: return values.set(key.name, text);
      case OwnKey::Kind::kMotor:
        if (written == nullptr) return;
        if (const auto motor = motor_names_.find(*written, problems_))
          values.set(key.name, static_cast<double>(*motor));
        return;
      default: break;
    }
    if (const auto value = parseNumber(text)) values.set(key.name, *value);
  }

  Problems& problems_;
  MotorNames motor_names_;
  UniqueNames names_{"module name", "the robot"};
};

/// Sections that modules are built from, beside their own; "" for errors of the whole text.
constexpr std::array<std::string_view, 4> kBeforeModules{"", "scheduler", "buses", "profiles"};

}  // namespace

std::vector<ModuleConfig> buildModules(const Settings& robot, const std::vector<BusConfig>& buses,
                                       Problems& problems) {
  std::vector<ModuleConfig> modules;
  const auto given = robot.find("modules");
  if (!given) return modules;
  ModuleBuilder builder{buses, problems};
  for (std::size_t i = 0; i < given->node->items.size(); ++i) {
    const YamlNode& node = given->node->items[i];
    if (!node.refused) modules.push_back(builder.build(node, joinPath(given->path, i)));
  }
  return modules;
}

void checkModules(const RobotConfig& robot, Problems& problems) {
  const auto wrong = [&](std::string_view path) { return problems.hasErrorsIn(path); };
  if (problems.full() || std::any_of(kBeforeModules.begin(), kBeforeModules.end(), wrong)) return;
  const RobotOutline outline = outlineOf(robot);
  std::vector<std::unique_ptr<Module_Base>> built;
  std::vector<ModuleDirectory::Entry> entries;
  // A module's errors begin with the key.
  const auto complain = [&](std::size_t i, const Error& error) {
    const auto colon = error.message.find(": ");
    const std::string& path = robot.modules[i].path;
    if (colon == std::string::npos) return problems.error(robot.modules[i].place, path, error.message);
    problems.error(robot.modules[i].place, joinPath(path, error.message.substr(0, colon)),
                   error.message.substr(colon + 2));
  };
  for (std::size_t i = 0; i < robot.modules.size(); ++i) {
    const auto& config = robot.modules[i];
    if (wrong(config.path)) continue;
    auto module = config.type->build(config.settings, outline);
    if (!module) {
      complain(i, module.error());
      continue;
    }
    entries.push_back({config.settings.name, module->get()});
    built.push_back(std::move(*module));
  }
  // In a robot with errors, no module knows whether what it reads of another is there.
  if (problems.hasErrors()) return;
  const ModuleDirectory directory{entries};
  DeviceClaims claims{robot};
  for (std::size_t i = 0; i < built.size(); ++i) {
    if (auto connected = built[i]->connect(directory); !connected) complain(i, connected.error());
    for (const auto& taken : claims.claim(*built[i], robot.modules[i].settings.name)) complain(i, {taken});
  }
}

}  // namespace rc10
