#include "daemon/guard_link.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "daemon/child_process.hpp"
#include "daemon/exchange/clock.hpp"
#include "link/descriptor_message.hpp"
#include "link/run_dir.hpp"
#include "link/unix_address.hpp"

namespace rc10 {
namespace {

// A guard that has just been started opens its CAN sockets first.
constexpr Duration kPatience = std::chrono::seconds{1};
constexpr auto kRetryPause = std::chrono::milliseconds{5};
constexpr Duration kRetry = std::chrono::seconds{1};

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

Result<std::unique_ptr<GuardLink>> GuardLink::create(Settings settings) {
  auto page = link::SharedGuardPage::create();
  if (!page) return tl::unexpected(page.error());
  UniqueFd self{static_cast<int>(::syscall(SYS_pidfd_open, ::getpid(), 0))};
  if (!self) return fail(fmt::format("no pidfd for rc10-guard: {}", std::strerror(errno)));
  std::unique_ptr<GuardLink> link{new GuardLink(std::move(settings), std::move(*page), std::move(self))};
  if (auto connected = link->connect(); !connected) return tl::unexpected(connected.error());
  return link;
}

Result<void> GuardLink::connect() {
  const std::string path = link::guardSocketPath(settings_.run_dir);
  const auto deadline = monotonicNow() + kPatience;
  for (bool started = false;;) {
    auto attempt = connectTo(path);
    if (attempt.error == 0) {
      auto watched = sayHello(attempt.connection.get());
      if (watched) connection_ = std::move(attempt.connection);
      return watched;
    }
    // No guard, or one that is gone: another one is started, once.
    const bool none = attempt.error == ENOENT || attempt.error == ECONNREFUSED;
    if (!none) return fail(fmt::format("rc10-guard: {}: {}", path, std::strerror(attempt.error)));
    if (!started) {
      const auto child = startChild(settings_.program, {"--until-unused"}, {.own_session = true});
      if (!child) return tl::unexpected(child.error());
      child_ = *child;
      started = true;
    }
    if (monotonicNow() >= deadline)
      return fail(fmt::format("{} was started and does not answer at {}", settings_.program, path));
    std::this_thread::sleep_for(kRetryPause);
  }
}

Result<void> GuardLink::sayHello(int connection) {
  page_->beats.store(0, std::memory_order_relaxed);  // of another guard
  const std::array descriptors{page_.descriptor(), self_.get()};
  if (!link::sendWithDescriptors(connection, link::guardHelloText(settings_.hello), descriptors))
    return fail(fmt::format("rc10-guard cannot be told what to watch: {}", std::strerror(errno)));
  link::DescriptorMessage answer;
  if (!readable(connection, kPatience)) return fail("rc10-guard does not answer");
  if (!link::receiveWithDescriptors(connection, answer)) return fail("rc10-guard has hung up");
  if (answer.text == link::kGuardArmed) return {};
  return fail("rc10-guard does not watch: " + answer.text);
}

void GuardLink::reap() noexcept {
  if (child_ != 0 && ::waitpid(child_, nullptr, WNOHANG) != 0) child_ = 0;
}

GuardLink::News GuardLink::supervise(MonotonicTime now) {
  reap();
  if (connection_) {
    if (!readable(connection_.get(), Duration{0})) return watchBeats(now);
    connection_.reset();  // the guard says nothing more: this is its end
    next_try_ = now;
    return {.lost = true, .text = "rc10-guard has ended: nobody watches rc10d; e-stop"};
  }
  if (now < next_try_) return {};
  next_try_ = now + kRetry;
  const auto connected = connect();
  beats_ = {};
  return {.text = connected ? "rc10-guard watches again" : connected.error().message};
}

// The connection stays: a guard that goes on watches as before.
GuardLink::News GuardLink::watchBeats(MonotonicTime now) {
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

void GuardLink::end() noexcept {
  page_->ended.store(true, std::memory_order_release);
  connection_.reset();
}

}  // namespace rc10
