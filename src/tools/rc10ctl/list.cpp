#include <cstdio>

#include <CLI/CLI.hpp>

#include "client/state_json.hpp"
#include "client/state_text.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

ExitCode list(const Global& global) {
  const auto rc10d = connect(global);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  const auto& welcome = rc10d->welcome();
  std::fputs((global.json ? client::listJson(welcome) + "\n" : client::listText(welcome)).c_str(), stdout);
  return ExitCode::kOk;
}

}  // namespace

void addList(CLI::App& app, Action& action) {
  app.add_subcommand("list", "the robot, its motors, their models, buses, ids and modes")
      ->callback([&action] { action = list; });
}

}  // namespace rc10::ctl
