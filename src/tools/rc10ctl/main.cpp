#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "app/spelling.hpp"
#include "app/standard_output.hpp"
#include "rc10_version.hpp"
#include "verbs.hpp"

namespace {

constexpr const char* kDescription =
    "Shows and commands the motors of a running rc10d. Needs no LCM.\n"
    "Exit status: 0 done, 1 the operation failed, 2 wrong usage, 3 rc10d cannot be reached.";

constexpr const char* kExamples =
    "Examples:\n"
    "  rc10ctl list                                     what motors there are\n"
    "  rc10ctl watch                                    what they do, live\n"
    "  rc10ctl enable front_left\n"
    "  rc10ctl set front_left velocity 120 --for 2s     turns it at 120 rpm for two seconds\n"
    "  rc10ctl estop                                    stops everything";

// They move a motor before the eyes of a person. Every other verb answers in JSON if asked to.
constexpr std::array<std::string_view, 3> kForEyes{"set", "jog", "commission"};

int run(int argc, char** argv) {
  using namespace rc10::ctl;
  CLI::App app{kDescription, "rc10ctl"};
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("rc10ctl ") + rc10::kVersion);
  app.require_subcommand(1);
  app.fallthrough();  // global options may stand behind the verb too
  Global global;
  app.add_option("--robot", global.robot, "the robot; needed only if several run here")->type_name("NAME");
  app.add_option("--socket", global.socket, "rc10d's link socket, default /run/rc10d/<robot>.sock")
      ->type_name("PATH");
  app.add_flag("--json", global.json,
               "answers, and says what went wrong, in JSON, one object a line; not set, jog, commission");
  Action action;
  for (const auto add :
       {addList,   addWatch, addStats,          addRequests,   addZero,         addSet,      addModules,
        addSignal, addGains, addConfigureDrive, addCheck,      addConvertGains, addBlackbox, addDoctor,
        addScan,   addJog,   addCommission,     addTestMotion, addHand,         addLoad,     addConfig,
        addWeb})
    add(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return static_cast<int>(complain({rc10::usageError(app, error, argc, argv)}, ExitCode::kUsage));
  }
  if (global.json) complainInJson();
  const std::string verb = app.get_subcommands().front()->get_name();
  if (global.json && std::find(kForEyes.begin(), kForEyes.end(), verb) != kForEyes.end()) {
    return static_cast<int>(complain(
        {verb +
         " shows a motor that moves, not JSON: leave out --json; `rc10ctl watch --json` tells what it does"},
        ExitCode::kUsage));
  }
  catchInterrupt();
  return static_cast<int>(action(global));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return rc10::statusOfOutput("rc10ctl", run(argc, argv));
  } catch (const std::exception& error) {  // no memory, for example
    std::fprintf(stderr, "rc10ctl: %s\n", error.what());
    return static_cast<int>(rc10::ctl::ExitCode::kFailed);
  }
}
