#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "ask.hpp"
#include "named_value.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

struct LoadOptions {
  std::string motor;
  std::vector<std::string> changes;
  bool reset = false;
};

ExitCode load(const Global& global, const LoadOptions& options) {
  if (options.changes.empty() != options.reset)
    return complain({"load: say what changes, such as payload_kg=0.5, or --reset"}, ExitCode::kUsage);
  if (options.changes.size() > link::kMaxValues)
    return complain({"load: too many values at once: do it in parts"}, ExitCode::kUsage);
  std::vector<link::NamedValue> values;
  for (const auto& text : options.changes) {
    const auto value = namedValue(text, "payload_kg=0.5");
    if (!value) return complain(value.error(), ExitCode::kUsage);
    values.push_back(*value);
  }
  return ask(global, Operation::kLoad, {options.motor}, values);
}

}  // namespace

void addLoad(CLI::App& app, Action& action) {
  const auto options = std::make_shared<LoadOptions>();
  auto* verb = app.add_subcommand(
      "load",
      "hangs another load on the shaft of a simulated motor while it runs: inertia, friction, weight");
  verb->add_option("motor", options->motor, "name of the motor; its bus has `type: sim`")
      ->required()
      ->type_name("MOTOR");
  verb->add_option(
          "changes", options->changes,
          "what changes: inertia_kg_m2, viscous_nms_per_rad, coulomb_nm, load_torque_nm, gravity_nm, "
          "payload_kg, payload_at_m, as in `simulated` of the robot's file")
      ->type_name("KEY=VALUE");
  verb->add_flag("--reset", options->reset, "the load as at the start of rc10d");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return load(global, *options); }; });
}

}  // namespace rc10::ctl
