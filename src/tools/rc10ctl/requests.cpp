#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "ask.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

void addRequest(CLI::App& app, Action& action, Operation operation, const char* description,
                bool takes_motors) {
  const auto motors = std::make_shared<std::vector<std::string>>();
  auto* verb = app.add_subcommand(toString(operation), description);
  if (takes_motors) verb->add_option("motors", *motors, "names of motors; none: all")->type_name("MOTOR");
  verb->callback([&action, operation, motors] {
    action = [operation, motors](const Global& global) { return ask(global, operation, *motors); };
  });
}

}  // namespace

void addRequests(CLI::App& app, Action& action) {
  addRequest(app, action, Operation::kEnable, "makes motors obey commands; says which cannot and why", true);
  addRequest(app, action, Operation::kDisable, "takes the torque from motors", true);
  addRequest(app, action, Operation::kEstop, "stops every motor at once; stays until `clear`", false);
  addRequest(app, action, Operation::kClear, "clears the e-stop and the faults of motors", true);
}

}  // namespace rc10::ctl
