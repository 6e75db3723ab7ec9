#include "daemon/daemon_main.hpp"

#include <iostream>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/spelling.hpp"
#include "config/load_config.hpp"
#include "config/report/report.hpp"
#include "config/report/schema.hpp"
#include "config/report/template.hpp"
#include "daemon/daemon.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/interfaces/interface_wait.hpp"
#include "daemon/log.hpp"
#include "daemon/refusal.hpp"
#include "daemon/rt_process.hpp"
#include "daemon/service_notify.hpp"
#include "daemon/signal_inbox.hpp"
#include "rc10_version.hpp"

namespace rc10 {
namespace {

// sysexits-like, documented in `rc10d --help`.
constexpr int kOk = 0;
constexpr int kStartFailed = 1;
constexpr int kBadUsageOrConfig = 2;

struct Loaded {
  ConfigOutcome outcome;
  std::string told;  ///< Its problems, as they were printed.
};

/// Loads a configuration and prints everything that is wrong with it.
Loaded load(const std::string& file) {
  Loaded loaded{.outcome = loadRobotConfig(file), .told = {}};
  loaded.told = loaded.outcome.text();
  if (!loaded.outcome.config) {
    const auto count = loaded.outcome.errors.size();
    loaded.told += fmt::format("{}: {} error{}\n", file, count, count == 1 ? "" : "s");
  }
  std::cerr << loaded.told;
  return loaded;
}

/// False: a signal has asked to stop.
bool waitAsService(const RobotConfig& config, SignalInbox& signals, spdlog::logger& log) {
  const InterfaceWait wait{config};
  if (!runByService() || wait.missing().empty()) return true;
  log.info("CAN interface '{}' is not there yet: waiting for it", wait.missing());
  const MonotonicTime ends = monotonicNow() + InterfaceWait::kLongest;
  while (wait.run(signals.descriptor(), ends - monotonicNow()) == InterfaceWait::End::kSignal) {
    for (int signal = signals.take(); signal != 0; signal = signals.take()) {
      log.info("{} while waiting", describeSignal(signal));
      if (meaningOf(signal) == SignalMeaning::kStop) return false;
    }
  }
  return true;
}

int run(RobotConfig config, const std::string& source) {
  const std::string file = config.file;
  const std::string robot = config.robot;
  SignalInbox signals;         // before the log, which starts a thread
  const auto log = makeLog();  // while /proc is open to it
  // A debugger and a core file need what this forbids.
  if (config.guard != GuardPolicy::kOff) forbidDumps();
  if (!waitAsService(config, signals, *log)) return kOk;
  Daemon daemon(std::move(config), log);
  if (const auto started = daemon.start(); !started) {
    std::cerr << "rc10d: " << started.error().message << '\n';
    leaveRefusal(file, file + ": " + started.error().message + "\n", source);
    return kStartFailed;
  }
  takeRefusalBack(file);
  leaveConfig(robot, source);
  daemon.waitForSignal(signals);
  daemon.stop();
  return kOk;
}

}  // namespace

int daemonMain(int argc, char** argv) {
  configureMemory();
  CLI::App app{
      "Real-time motor daemon: drives the motors of one robot over CAN, commanded through LCM.\n"
      "Exit status: 0 stopped by a signal, 1 could not start, 2 bad usage or configuration.",
      "rc10d"};
  std::string config_file;
  std::string check_file;
  bool schema = false;
  bool init = false;
  auto* run_option =
      app.add_option("-c,--config", config_file, "run the robot that FILE describes")->type_name("FILE");
  auto* check_option =
      app.add_option("--check", check_file, "check FILE, print what the robot would be, and exit")
          ->type_name("FILE")
          ->excludes(run_option);
  auto* schema_option =
      app.add_flag("--schema", schema, "print the JSON schema of the configuration, and exit");
  auto* init_option = app.add_flag("--init", init, "print a configuration to begin with, and exit");
  app.set_version_flag("--version", std::string("rc10d ") + kVersion);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const bool extra = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
    std::cerr << "rc10d: " << usageError(app, error, argc, argv)
              << (extra ? "; -c FILE runs a robot, --check FILE checks one" : "") << '\n';
    return kBadUsageOrConfig;
  }

  if (*schema_option) {
    std::cout << configSchema();
    return kOk;
  }
  if (*init_option) {
    std::cout << configTemplate();
    return kOk;
  }
  if (config_file.empty() && check_file.empty()) {
    std::cerr << "rc10d: nothing to do: give -c FILE to run a robot or --check FILE to check one\n";
    return kBadUsageOrConfig;
  }
  auto [outcome, told] = load(*check_option ? check_file : config_file);
  if (!outcome.config) {
    if (!*check_option) leaveRefusal(config_file, told, outcome.source);
    return kBadUsageOrConfig;
  }
  if (*check_option) {
    std::cout << describe(*outcome.config);
    return kOk;
  }
  return run(std::move(*outcome.config), outcome.source);
}

}  // namespace rc10
