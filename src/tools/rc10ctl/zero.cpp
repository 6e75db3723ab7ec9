#include <memory>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "ask.hpp"
#include "verbs.hpp"

namespace rc10::ctl {

void addZero(CLI::App& app, Action& action) {
  struct Options {
    std::string motor;
    double angle_deg = 0.0;
  };
  const auto options = std::make_shared<Options>();
  auto* verb = app.add_subcommand("zero", "says at which angle a motor stands now; not while it is ACTIVE");
  verb->add_option("motor", options->motor, "name of the motor")->required()->type_name("MOTOR");
  verb->add_option("angle", options->angle_deg, "its present angle in degrees")
      ->type_name("DEG")
      ->capture_default_str();
  verb->callback([&action, options] {
    action = [options](const Global& global) {
      const link::NamedValue angle{.name = std::string_view{"angle_deg"}, .value = options->angle_deg};
      return ask(global, Operation::kZero, {options->motor}, {angle});
    };
  });
}

}  // namespace rc10::ctl
