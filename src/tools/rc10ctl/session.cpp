#include "session.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>

#include "client/daemon_log.hpp"
#include "client/find_robot.hpp"
#include "client/json_line.hpp"

namespace rc10::ctl {
namespace {

volatile std::sig_atomic_t interrupt_seen = 0;
bool json_wanted = false;

}  // namespace

Result<std::string> socketOf(const Global& global) {
  if (global.socket) return *global.socket;
  const auto robot = findRobot(global.robot);
  if (!robot) return tl::unexpected(robot.error());
  return robot->path;
}

Result<LinkClient> connect(const Global& global, std::uint32_t subscriptions) {
  const auto path = socketOf(global);
  if (!path) return tl::unexpected(path.error());
  return LinkClient::connect(*path, {.name = kClientName, .subscriptions = subscriptions});
}

ExitCode complain(const Error& error, ExitCode code) {
  if (json_wanted) std::puts(client::lineOf({{"error", error.message}}).c_str());
  std::fflush(stdout);
  std::fprintf(stderr, "rc10ctl: %s\n", error.message.c_str());
  return code;
}

void complainInJson() { json_wanted = true; }

Error rc10dEnded() {
  std::string what = "rc10d has ended: ";  // not in one expression: GCC 12 warns of a read beyond its end
  return {what += client::kSeeItsLog};
}

bool interrupted() noexcept { return interrupt_seen != 0; }

void catchInterrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupt_seen = 1; };  // no SA_RESTART: it ends poll()
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
}

bool stdinEnded() noexcept {
  pollfd entry{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (::poll(&entry, 1, 0) <= 0) return false;
  if ((entry.revents & POLLIN) == 0) return true;  // closed
  std::array<char, 256> thrown_away{};
  return ::read(STDIN_FILENO, thrown_away.data(), thrown_away.size()) == 0;
}

void waitReadable(const LinkClient& rc10d, Duration timeout) {
  // Rounded up, or the last millisecond would be spent spinning; short, since Ctrl-C may come in between.
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  pollfd entry{.fd = rc10d.descriptor(), .events = POLLIN, .revents = 0};
  (void)::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(wait, 0, 100)));
}

}  // namespace rc10::ctl
