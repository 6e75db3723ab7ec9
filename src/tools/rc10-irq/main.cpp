// rc10-irq: lifts the kernel's threads that serve CAN interfaces above those of rc10d. The kernel makes the
// interrupt thread when the interface comes up, at priority 50, so it has to be done again each time.

#include <linux/capability.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/nearest.hpp"
#include "app/result.hpp"
#include "can_link_watch.hpp"
#include "doctor/interrupt_threads.hpp"
#include "program.hpp"
#include "rc10_version.hpp"
#include "thread_priorities.hpp"

namespace rc10 {
namespace {

// A new interrupt thread gives itself its 50 as the first thing it does, which may be after the kernel told
// that the interface is up. So what was changed is looked at again until it stays, but not for ever: somebody
// else may set it too.
constexpr int kLookAgainMs = 100;
constexpr int kMostLooks = 10;

struct Options {
  std::vector<std::string> interfaces;
  int priority = doctor::kInterruptPriority;
  bool watch = false;
};

int complain(const Error& error, int exit_code) {
  std::fprintf(stderr, "rc10-irq: %s\n", error.message.c_str());
  return exit_code;
}

bool hasTheRight() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> data{};
  return ::syscall(SYS_capget, &header, data.data()) == 0 &&
         (data[CAP_TO_INDEX(CAP_SYS_NICE)].effective & CAP_TO_MASK(CAP_SYS_NICE)) != 0;
}

Result<void> once(const ThreadPriorities& priorities) {
  for (int look = 0; look < kMostLooks; ++look) {
    const auto changed = priorities.apply();
    if (!changed) return tl::unexpected(changed.error());
    if (!*changed) break;
    ::poll(nullptr, 0, kLookAgainMs);
  }
  priorities.tellMissing();
  return {};
}

void printReady(const Options& options) {
  std::string names;
  for (const auto& interface : options.interfaces) names += (names.empty() ? "" : ", ") + interface;
  std::printf("watching %s for links that come up: priority %d\n",
              names.empty() ? "all CAN interfaces" : names.c_str(), options.priority);
  std::fflush(stdout);
}

Result<void> watch(const Options& options, const ThreadPriorities& priorities) {
  const auto signals = makeSignals();
  if (!signals) return tl::unexpected(signals.error());
  // Before the first look, so that nothing happens unseen between the two.
  const auto links = CanLinkWatch::open();
  if (!links) return tl::unexpected(links.error());
  printReady(options);
  std::array<pollfd, 2> waited{pollfd{links->fd(), POLLIN, 0}, pollfd{signals->get(), POLLIN, 0}};
  for (int looks = kMostLooks;;) {
    bool changed = false;
    if (looks > 0) {
      const auto applied = priorities.apply();
      if (!applied) return tl::unexpected(applied.error());
      changed = *applied;
      looks = changed ? looks - 1 : 0;
    }
    if (::poll(waited.data(), waited.size(), looks > 0 ? kLookAgainMs : -1) < 0 && errno != EINTR) {
      return fail(systemError("poll"));
    }
    if (waited[1].revents != 0) return {};
    const auto news = links->read();
    if (!news) return tl::unexpected(news.error());
    if (news->lost || priorities.concern(news->links)) looks = kMostLooks;
  }
}

/// Error for an interface that is missing in a single run; a watch waits for it.
Result<void> checkPresence(const Options& options, const std::vector<std::string>& present) {
  for (const auto& interface : options.interfaces) {
    if (std::find(present.begin(), present.end(), interface) != present.end()) continue;
    return fail(interface + ": there is no such CAN interface" +
                didYouMean(interface, {present.begin(), present.end()}) +
                "; `ip link` lists what there is, and --watch waits for it");
  }
  if (present.empty()) return fail("this computer has no CAN interface; --watch waits for one");
  return {};
}

int run(const Options& options) {
  if (!hasTheRight()) {
    return complain({"the priority of the kernel's threads is not yours to set: that needs CAP_SYS_NICE; run "
                     "it with sudo, or: sudo systemctl enable --now rc10-irq.service"},
                    kExitFailed);
  }
  const ThreadPriorities priorities(options.interfaces, options.priority);
  Result<void> outcome;
  if (options.watch) {
    outcome = watch(options, priorities);
  } else {
    outcome = checkPresence(options, priorities.present()).and_then([&] { return once(priorities); });
  }
  return outcome ? kExitOk : complain(outcome.error(), kExitFailed);
}

int parseAndRun(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Lifts the kernel's threads that serve CAN interfaces (irq/…, spi0) above those of rc10d: SCHED_FIFO "
      "with one priority. An interface that comes up has a new interrupt thread, with the kernel's 50.",
      "rc10-irq"};
  app.add_option("interface", options.interfaces, "CAN interfaces; default: all, whenever they appear")
      ->type_name("INTERFACE");
  app.add_option("--priority", options.priority, "default 70: above rc10d's receive thread, which has 65")
      ->check(CLI::Range(1, 98))
      ->type_name("N");
  app.add_flag("--watch", options.watch, "stay, and do it again each time that one comes up");
  app.set_version_flag("--version", std::string("rc10-irq ") + kVersion);
  app.footer(
      "It needs CAP_SYS_NICE: sudo, or the service rc10-irq.\n"
      "Exit status: 0 all have it, or --watch was ended; 1 failed; 2 bad usage.");
  if (const auto ended = parseCommandLine(app, argc, argv)) return *ended;
  return run(options);
}

}  // namespace
}  // namespace rc10

int main(int argc, char** argv) { return rc10::runProgram("rc10-irq", rc10::parseAndRun, argc, argv); }
