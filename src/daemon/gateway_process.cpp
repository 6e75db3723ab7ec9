#include "daemon/gateway_process.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>

#include "app/unique_fd.hpp"
#include "daemon/child_process.hpp"

namespace rc10 {
namespace {

constexpr Duration kFirstBackoff = std::chrono::milliseconds{100};
constexpr Duration kLongestBackoff = std::chrono::seconds{5};
// One that ran this long was well: the next start is quick again.
constexpr Duration kHealthyAfter = std::chrono::seconds{10};
constexpr int kStopTimeoutMs = 500;

[[nodiscard]] std::string howItEnded(int status) {
  if (WIFSIGNALED(status)) return fmt::format("killed by signal {}", WTERMSIG(status));
  return fmt::format("exit status {}", WEXITSTATUS(status));
}

[[nodiscard]] std::string stoppedText(pid_t pid) {
  return fmt::format(
      "rc10-lcm (pid {0}) stands still (SIGSTOP): nothing from LCM gets here, an e-stop neither, "
      "and no state leaves. Let it go on (`kill -CONT {0}`), or kill it: another one is started",
      pid);
}

}  // namespace

GatewayProcess::GatewayProcess(std::string program, std::vector<std::string> arguments)
    : program_(std::move(program)), arguments_(std::move(arguments)), backoff_(kFirstBackoff) {}

Result<void> GatewayProcess::spawn() {
  const auto child = startChild(program_, arguments_);
  if (!child) return tl::unexpected(child.error());
  pid_ = *child;
  return {};
}

std::string GatewayProcess::supervise(MonotonicTime now) {
  std::string message;
  int status = 0;
  if (pid_ == 0 || waitpid(pid_, &status, WNOHANG | WUNTRACED | WCONTINUED) != pid_) {
    // It is as before.
  } else if (WIFSTOPPED(status)) {
    message = stoppedText(pid_);
  } else if (WIFCONTINUED(status)) {
    message = "rc10-lcm goes on";
  } else {
    if (now - started_ >= kHealthyAfter) backoff_ = kFirstBackoff;
    next_start_ = now + backoff_;
    message = fmt::format("rc10-lcm ended ({}); starting it again in {} ms", howItEnded(status),
                          std::chrono::duration_cast<std::chrono::milliseconds>(backoff_).count());
    backoff_ = std::min(backoff_ * 2, kLongestBackoff);
    pid_ = 0;
  }
  if (pid_ == 0 && now >= next_start_) {
    started_ = now;
    if (const auto started = spawn(); !started) {
      next_start_ = now + kLongestBackoff;
      message = started.error().message;
    }
  }
  return message;
}

void GatewayProcess::stop() noexcept {
  if (pid_ == 0) return;
  const UniqueFd pidfd{static_cast<int>(syscall(SYS_pidfd_open, pid_, 0))};
  kill(pid_, SIGTERM);
  pollfd poll_for{.fd = pidfd.get(), .events = POLLIN, .revents = 0};
  if (::poll(&poll_for, 1, kStopTimeoutMs) != 1) kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

}  // namespace rc10
