// rc10-guard: the last word to the drives when rc10d dies or hangs. It has their rest frames from rc10d, and
// shares nothing else with it but a counter of ticks.

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include "app/guard_priority.hpp"
#include "app/nearest.hpp"
#include "app/printable.hpp"
#include "app/standard_output.hpp"
#include "app/stderr_lines.hpp"
#include "guard/guard_server.hpp"
#include "guard/guard_socket.hpp"
#include "link/run_dir.hpp"
#include "rc10_version.hpp"

namespace rc10::guard {
namespace {

constexpr int kOk = 0;
constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

// A service manager that ends us while drives are told to rest waits longer.
constexpr int kLastSteps = 1000 / static_cast<int>(Standstill::kStepMs);

constexpr std::array kEnding{SIGTERM, SIGINT, SIGHUP, SIGQUIT};
// Its own, and those that nobody can ignore.
constexpr std::array kFaults{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS, SIGKILL, SIGSTOP};

constexpr std::string_view kHelp = R"(usage: rc10-guard [--until-unused]

Watches every rc10d of the run folder. When one dies without an orderly end, or its ticks stand
still, the guard sends rest frames (no torque) to its drives until the bus has carried them three
times. rc10d starts one in a session of its own where none runs; the package has a unit.
While a guard runs, the end of the guard is an e-stop of the robots that it watches.

  --until-unused   end when no robot is watched any more
  --help, --version

RC10_RUN_DIR replaces /run/rc10d.
Exit status: 0 ended by a signal or unused, 1 could not start, 2 bad usage.
)";

volatile std::sig_atomic_t ending = 0;

const StderrLines& lines() {
  static const StderrLines kLines;
  return kLines;
}

// Nobody watches while a guard waits for the reader of a line.
void tell(const std::string& line) { (void)lines().tell("rc10-guard: " + rc10::printable(line)); }

/// The signals that end it act only while it waits; the mask for that is returned. Any other is no reason to
/// leave the drives, as of a line on a file at its limit (ulimit -f) or on a terminal with `stty tostop`.
sigset_t catchSignals() noexcept {
  struct sigaction action {};
  action.sa_handler = [](int) { ending = 1; };
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    if (std::find(kFaults.begin(), kFaults.end(), signal) == kFaults.end()) ::signal(signal, SIG_IGN);
  }
  sigset_t blocked;
  ::sigemptyset(&blocked);
  for (const int signal : kEnding) {
    ::sigaction(signal, &action, nullptr);
    ::sigaddset(&blocked, signal);
  }
  sigset_t before;
  ::sigprocmask(SIG_BLOCK, &blocked, &before);
  return before;
}

// A refused right costs reaction time, not the guard: rc10d says whether real time is required.
void becomeRealTime() {
  sched_param param{};
  param.sched_priority = kGuardPriority;
  if (::sched_setscheduler(0, SCHED_FIFO, &param) != 0)
    tell("not real-time: SCHED_FIFO " + std::to_string(kGuardPriority) + " was refused (" +
         std::strerror(errno) + ")");
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    tell(std::string("not real-time: memory could not be locked (") + std::strerror(errno) + ")");
}

int run(bool until_unused) {
  const sigset_t while_waiting = catchSignals();
  (void)lines();  // while /proc is open to it
  (void)::prctl(PR_SET_DUMPABLE, 0);
  auto socket = GuardSocket::listen(link::runDir());
  if (!socket) {
    tell(socket.error().message);
    return kFailed;
  }
  becomeRealTime();
  GuardServer server{std::move(*socket)};
  for (int last_steps = 0; last_steps < kLastSteps;) {
    for (const auto& line : server.serve(while_waiting)) tell(line);
    if (until_unused && server.unused()) break;
    if (ending != 0 && (!server.rests() || ++last_steps == kLastSteps)) break;
  }
  return kOk;
}

}  // namespace
}  // namespace rc10::guard

int main(int argc, char** argv) {
  using namespace rc10::guard;
  bool until_unused = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--help" || word == "--version") {
      const std::string version = std::string("rc10-guard ") + rc10::kVersion + "\n";
      std::fputs(word == "--help" ? std::string(kHelp).c_str() : version.c_str(), stdout);
      return rc10::statusOfOutput("rc10-guard", kOk);
    }
    if (word != "--until-unused") {
      tell("'" + std::string(word) + "' is no option" +
           rc10::didYouMean(word, {"--until-unused", "--help", "--version"}) + "; --help lists them");
      return kBadUsage;
    }
    until_unused = true;
  }
  try {
    return run(until_unused);
  } catch (const std::exception& error) {
    tell(error.what());
    return kFailed;
  }
}
