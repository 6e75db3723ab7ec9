#include "robot_file/this_computer.hpp"

#include <pwd.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "robot_file/at_rest.hpp"
#include "robot_file/program_run.hpp"

namespace rc10::robot_file {
namespace {

constexpr const char* kPkcheck = "/usr/bin/pkcheck";
constexpr const char* kRc10d = "/usr/bin/rc10d";
// The input of runProgram().
constexpr const char* kText = "/proc/self/fd/0";
constexpr const char* kSystemctl = "/usr/bin/systemctl";

std::string userName(uid_t user) {
  const auto* entry = ::getpwuid(user);
  return entry == nullptr ? std::to_string(user) : std::string{entry->pw_name};
}

// The process by number and start, so that no other has its place.
std::string subjectOf(const Caller& caller) {
  return std::to_string(caller.process.pid) + "," + std::to_string(caller.process.start_ticks) + "," +
         std::to_string(caller.user);
}

Result<void> allowedByPolkit(const Caller& caller, client::FileVerb verb) {
  if (caller.user == 0) return {};
  const auto action = polkitAction(verb);
  const auto end = runProgram({kPkcheck, "--action-id", action, "--process", subjectOf(caller)});
  if (!end) return tl::unexpected(end.error());
  if (end->status == 0) return {};
  if (end->status == ProgramEnd::kNotStarted)
    return fail("there is no polkit, which decides: `sudo apt install polkitd`");
  return fail("polkit does not allow user '" + userName(caller.user) + "' " + action +
              ": a rule for it is in /usr/share/rc10d/polkit");
}

void replaceAll(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

Result<std::string> rc10dsVerdict(const std::string& text) {
  const auto* user = ::getpwnam("rc10d");
  if (user == nullptr) return fail("there is no user rc10d: `sudo systemd-sysusers`");
  auto end =
      runProgram({kRc10d, "--check", kText}, text, LesserUser{.user = user->pw_uid, .group = user->pw_gid});
  if (!end) return tl::unexpected(end.error());
  replaceAll(end->output, kText, "robot.yaml");
  if (end->status == 0) return std::move(end->output);
  constexpr int kBadConfig = 2;
  if (end->status == kBadConfig) return fail(std::move(end->output));
  return fail("rc10d --check ended with " + std::to_string(end->status) + ":\n" + end->output);
}

/// ActiveState and MainPID of a unit.
struct UnitState {
  std::string active;
  int pid = 0;
};

Result<UnitState> stateOf(const std::string& unit) {
  const auto end = runProgram({kSystemctl, "show", "--property=ActiveState", "--property=MainPID", unit});
  if (!end) return tl::unexpected(end.error());
  UnitState state;
  std::string_view left = end->output;
  while (!left.empty()) {
    const auto line = left.substr(0, left.find('\n'));
    left.remove_prefix(std::min(line.size() + 1, left.size()));
    const auto value = line.substr(std::min(line.find('=') + 1, line.size()));
    if (line.starts_with("ActiveState=")) state.active = value;
    if (line.starts_with("MainPID="))
      (void)std::from_chars(value.data(), value.data() + value.size(), state.pid);
  }
  return state;
}

Result<void> unitAtRest(const std::string& robot, const std::string& unit) {
  const auto state = stateOf(unit);
  if (!state) return tl::unexpected(state.error());
  // With a wrong file it did not start: no process holds a motor.
  if (state->active == "failed") return {};
  if (state->pid == 0)
    return fail(unit + " is " + (state->active.empty() ? "not known" : state->active) +
                ", and a page does not start what somebody has stopped: `sudo systemctl start " + unit + "`");
  return robotAtRest(robot, state->pid);
}

Result<void> restartUnit(const std::string& unit) {
  // Earlier starts with a wrong file would count.
  (void)runProgram({kSystemctl, "reset-failed", unit});
  const auto end = runProgram({kSystemctl, "restart", unit});
  if (!end) return tl::unexpected(end.error());
  if (end->status == 0) return {};
  return fail(unit + " does not start: `journalctl -u " + unit + "`\n" + end->output);
}

}  // namespace

std::string polkitAction(client::FileVerb verb) {
  return std::string{"org.rc10d.config."} + client::toString(verb);
}

Computer thisComputer() {
  return {
      .authorise = allowedByPolkit, .check = rc10dsVerdict, .at_rest = unitAtRest, .restart = restartUnit};
}

}  // namespace rc10::robot_file
