#pragma once

#include <functional>

#include "session.hpp"

namespace CLI {
class App;
}

/// The verbs of rc10ctl, one file each. Each add...() gives the program a subcommand which, when it was
/// chosen, leaves in `action` what to do.
namespace rc10::ctl {

using Action = std::function<ExitCode(const Global& global)>;

void addList(CLI::App& app, Action& action);
void addWatch(CLI::App& app, Action& action);
void addStats(CLI::App& app, Action& action);
void addRequests(CLI::App& app, Action& action);  ///< enable, disable, estop, clear
void addZero(CLI::App& app, Action& action);
void addSet(CLI::App& app, Action& action);
void addModules(CLI::App& app, Action& action);
void addSignal(CLI::App& app, Action& action);
void addGains(CLI::App& app, Action& action);
void addConfigureDrive(CLI::App& app, Action& action);
void addCheck(CLI::App& app, Action& action);
void addConfig(CLI::App& app, Action& action);
void addConvertGains(CLI::App& app, Action& action);
void addBlackbox(CLI::App& app, Action& action);
void addDoctor(CLI::App& app, Action& action);
void addScan(CLI::App& app, Action& action);
void addJog(CLI::App& app, Action& action);
void addCommission(CLI::App& app, Action& action);
void addTestMotion(CLI::App& app, Action& action);
void addHand(CLI::App& app, Action& action);
void addLoad(CLI::App& app, Action& action);
void addWeb(CLI::App& app, Action& action);

}  // namespace rc10::ctl
