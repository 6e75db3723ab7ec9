#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "config/load_config.hpp"
#include "config/report.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

ExitCode check(const std::string& file) {
  const auto outcome = loadRobotConfig(file);
  std::fputs((outcome.errorText() + outcome.warningText()).c_str(), stderr);
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
  verb->callback([&action, file] { action = [file](const Global&) { return check(*file); }; });
}

}  // namespace rc10::ctl
