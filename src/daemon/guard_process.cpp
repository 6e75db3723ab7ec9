#include "daemon/guard_process.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fmt/format.h>

#include "app/errno_text.hpp"
#include "daemon/child_process.hpp"
#include "daemon/exchange/clock.hpp"
#include "link/descriptor_message.hpp"
#include "link/run_dir.hpp"
#include "link/unix_address.hpp"

namespace rc10 {
namespace {

// A guard that has just been started opens its CAN sockets first.
constexpr Duration kPatience = std::chrono::seconds{1};
constexpr Duration kRetryPause = std::chrono::milliseconds{5};
// Between the end of a try and the next one.
constexpr Duration kFirstPause = std::chrono::seconds{1};
constexpr Duration kLongestPause = std::chrono::seconds{5};

/// Error 0: connected. Else errno.
struct Attempt {
  UniqueFd connection;
  int error = 0;
};

Attempt connectTo(const std::string& path) noexcept {
  const auto address = link::unixAddress(path);
  if (!address) return {.connection = {}, .error = ENAMETOOLONG};
  UniqueFd socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (!socket || ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return {.connection = {}, .error = errno};
  return {.connection = std::move(socket)};
}

bool readable(int descriptor, Duration patience) noexcept {
  pollfd wait_for{.fd = descriptor, .events = POLLIN, .revents = 0};
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(patience).count();
  return ::poll(&wait_for, 1, static_cast<int>(ms)) == 1;
}

}  // namespace

Result<std::unique_ptr<GuardProcess>> GuardProcess::create(Settings settings) {
  auto page = link::SharedGuardPage::create();
  if (!page) return tl::unexpected(page.error());
  UniqueFd self{static_cast<int>(::syscall(SYS_pidfd_open, ::getpid(), 0))};
  if (!self) return fail(fmt::format("no pidfd for rc10-guard: {}", errnoText(errno)));
  std::unique_ptr<GuardProcess> link{
      new GuardProcess(std::move(settings), std::move(*page), std::move(self))};
  auto& tried = link->try_.emplace(Try{.deadline = monotonicNow() + kPatience});
  for (;;) {
    const auto watched = link->tryOn(tried, monotonicNow());
    if (!watched) return tl::unexpected(watched.error());
    if (*watched) return link;
    (void)readable(link->descriptor(), kRetryPause);
  }
}

Result<bool> GuardProcess::tryOn(Try& tried, MonotonicTime now) {
  if (!tried.greeted) {
    const std::string path = link::guardSocketPath(settings_.run_dir);
    auto attempt = connectTo(path);
    if (attempt.error != 0) {
      // No guard, or one that is gone: another one is started, once.
      const bool none = attempt.error == ENOENT || attempt.error == ECONNREFUSED;
      if (!none) return fail(fmt::format("rc10-guard: {}: {}", path, errnoText(attempt.error)));
      if (!tried.started && child_ == 0) {
        const auto child = startChild(settings_.program, {"--until-unused"}, {.own_session = true});
        if (!child) return tl::unexpected(child.error());
        child_ = *child;
        tried.started = true;
      }
      if (now < tried.deadline) return false;
      return fail(fmt::format("{} was started and does not answer at {}", settings_.program, path));
    }
    if (auto told = sayHello(attempt.connection.get()); !told) return tl::unexpected(told.error());
    tried =
        Try{.deadline = now + kPatience, .started = tried.started, .greeted = std::move(attempt.connection)};
  }
  if (!readable(tried.greeted.get(), Duration{0})) {
    if (now < tried.deadline) return false;
    return fail("rc10-guard does not answer");
  }
  link::DescriptorMessage answer;
  if (!link::receiveWithDescriptors(tried.greeted.get(), answer)) return fail("rc10-guard has hung up");
  if (answer.text != link::kGuardArmed) return fail("rc10-guard does not watch: " + answer.text);
  connection_ = std::move(tried.greeted);
  try_.reset();
  return true;
}

Result<void> GuardProcess::sayHello(int connection) {
  page_->beats.store(0, std::memory_order_relaxed);  // of another guard
  const std::array descriptors{page_.descriptor(), self_.get()};
  if (link::sendWithDescriptors(connection, link::guardHelloText(settings_.hello), descriptors)) return {};
  return fail(fmt::format("rc10-guard cannot be told what to watch: {}", errnoText(errno)));
}

void GuardProcess::reap() noexcept {
  if (child_ != 0 && ::waitpid(child_, nullptr, WNOHANG) != 0) child_ = 0;
}

GuardProcess::News GuardProcess::supervise(MonotonicTime now) {
  reap();
  if (connection_) {
    if (!readable(connection_.get(), Duration{0})) return watchBeats(now);
    connection_.reset();  // a guard that watches sends nothing: this is its end
    next_try_ = now;
    pause_ = kFirstPause;
    last_failure_.clear();
    return {.lost = true, .text = "rc10-guard has ended: nobody watches rc10d; e-stop"};
  }
  if (!try_) {
    if (now < next_try_) return {};
    try_ = Try{.deadline = now + kPatience};
  }
  const auto watched = tryOn(*try_, now);
  if (watched && !*watched) return {};
  beats_ = {};
  if (watched) return {.text = "rc10-guard watches again"};
  try_.reset();
  next_try_ = now + pause_;
  pause_ = std::min(2 * pause_, kLongestPause);
  // The same again and again: once is enough.
  if (watched.error().message == last_failure_) return {};
  last_failure_ = watched.error().message;
  return {.text = last_failure_};
}

// The connection stays: a guard that goes on watches as before.
GuardProcess::News GuardProcess::watchBeats(MonotonicTime now) {
  switch (beats_.look(page_->beats.load(std::memory_order_relaxed), now)) {
    case GuardBeats::News::kNone: break;
    case GuardBeats::News::kGoesOn: return {.text = "rc10-guard goes on, and watches again"};
    case GuardBeats::News::kStandsStill: {
      ucred guard{};
      socklen_t size = sizeof guard;
      (void)::getsockopt(connection_.get(), SOL_SOCKET, SO_PEERCRED, &guard, &size);
      return {
          .lost = true,
          .text = fmt::format("rc10-guard (pid {0}) stands still: nobody watches rc10d; e-stop. Let it go on "
                              "(`kill -CONT {0}`), or kill it: another one is started",
                              guard.pid)};
    }
  }
  return {};
}

void GuardProcess::end(bool at_rest) noexcept {
  if (at_rest) page_->ended.store(true, std::memory_order_release);
  connection_.reset();
  try_.reset();
}

}  // namespace rc10
