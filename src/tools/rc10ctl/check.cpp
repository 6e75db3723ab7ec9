#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "client/json_line.hpp"
#include "config/load_config.hpp"
#include "config/report/report.hpp"
#include "config/report/robot_json.hpp"
#include "robot_json.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

ExitCode checkInJson(const std::string& file, const ConfigOutcome& outcome) {
  std::puts(client::lineOf({{"file", file},
                            {"ok", outcome.config.has_value()},
                            {"errors", problemsJson(outcome.errors)},
                            {"warnings", problemsJson(outcome.warnings)},
                            {"robot", outcome.config ? robotJson(*outcome.config) : client::Json(nullptr)}})
                .c_str());
  return outcome.config ? ExitCode::kOk : ExitCode::kFailed;
}

ExitCode check(const Global& global, const std::string& file) {
  const auto outcome = loadRobotConfig(file);
  if (global.json) return checkInJson(file, outcome);
  std::fputs(outcome.text().c_str(), stderr);
  if (!outcome.config) {
    std::fprintf(stderr, "%s: %zu error%s\n", file.c_str(), outcome.errors.size(),
                 outcome.errors.size() == 1 ? "" : "s");
    return ExitCode::kFailed;
  }
  std::fputs(describe(*outcome.config).c_str(), stdout);
  return ExitCode::kOk;
}

}  // namespace

void addCheck(CLI::App& app, Action& action) {
  const auto file = std::make_shared<std::string>();
  auto* verb =
      app.add_subcommand("check", "says what is wrong with a configuration, or what the robot will be");
  verb->add_option("file", *file, "configuration of a robot")->required()->type_name("FILE");
  verb->callback([&action, file] { action = [file](const Global& global) { return check(global, *file); }; });
}

}  // namespace rc10::ctl
