#include "config/load_config.hpp"

#include <algorithm>
#include <exception>
#include <tuple>
#include <utility>

#include "config/build/module_builder.hpp"
#include "config/build/robot_builder.hpp"
#include "config/keys/key_check.hpp"
#include "config/sha256.hpp"
#include "config/yaml/source_text.hpp"
#include "config/yaml/yaml_reader.hpp"
#include "config/yaml/yaml_rules.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kWarning = "warning: ";

std::string listed(const std::vector<ConfigProblem>& problems, std::string_view kind = {}) {
  std::string text;
  for (const auto& problem : problems) text += toString(problem, kind) + "\n";
  return text;
}

/// Check by the motor layer itself. Earlier checks name the place; this one lets no configuration pass
/// that a motor would refuse.
void checkMotors(const RobotConfig& robot, Problems& problems) {
  for (const auto& bus : robot.buses) {
    // On a bus of its own, without a wire: the ids are held against each other as they will be.
    const auto wireless = fdCANbus::adopt(bus.name, UniqueFd{}, bus.data_bitrate > 0);
    BusParts parts{*wireless};
    std::vector<std::unique_ptr<Motor_Base>> built;
    for (const auto& motor : bus.motors) {
      auto made = motor.family->build(motor.settings, parts);
      if (made) {
        built.push_back(std::move(*made));
      } else {
        problems.error(motor.place, "", made.error().message);
      }
    }
  }
}

std::optional<RobotConfig> parse(std::string_view text, const std::string& file, Problems& problems) {
  if (!checkSource(text, problems)) return std::nullopt;
  auto root = readYaml(text, problems);
  if (!root) return std::nullopt;
  checkYamlRules(*root, problems);
  checkKeys(*root, kRobotSection, "", problems);
  RobotConfig robot = buildRobot(*root, problems);
  robot.file = file;
  robot.hash = sha256(text);
  if (!problems.hasErrors()) checkMotors(robot, problems);
  checkModules(robot, problems);
  return robot;
}

/// yaml-cpp and the standard library may throw (memory); nothing above this file has to know.
template <typename Work>
ConfigOutcome outcomeOf(std::string file, Work work) noexcept {
  Problems problems{std::move(file)};
  ConfigOutcome outcome;
  try {
    outcome.config = work(problems);
  } catch (const std::exception& thrown) {
    problems.error({}, "", std::string{"cannot be read: "} + thrown.what());
  }
  if (problems.hasErrors()) outcome.config.reset();
  outcome.errors = problems.errors();
  outcome.warnings = problems.warnings();
  return outcome;
}

}  // namespace

std::string ConfigOutcome::errorText() const { return listed(errors); }

std::string ConfigOutcome::warningText() const { return listed(warnings, kWarning); }

std::string ConfigOutcome::text() const {
  std::vector<std::pair<const ConfigProblem*, std::string_view>> all;
  all.reserve(errors.size() + warnings.size());
  for (const auto& problem : errors) all.emplace_back(&problem, "");
  for (const auto& problem : warnings) all.emplace_back(&problem, kWarning);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first->place.line, a.first->place.column) <
           std::tie(b.first->place.line, b.first->place.column);
  });
  std::string text;
  for (const auto& [problem, kind] : all) text += toString(*problem, kind) + "\n";
  return text;
}

ConfigOutcome loadRobotConfig(const std::string& path) {
  std::string source;
  auto outcome = outcomeOf(path, [&](Problems& problems) -> std::optional<RobotConfig> {
    auto text = readSource(path, problems);
    if (!text) return std::nullopt;
    source = std::move(*text);
    return parse(source, path, problems);
  });
  outcome.source = std::move(source);
  return outcome;
}

ConfigOutcome parseRobotConfig(std::string_view text, std::string file_name) {
  const std::string file = file_name;
  return outcomeOf(std::move(file_name), [&](Problems& problems) { return parse(text, file, problems); });
}

}  // namespace rc10
