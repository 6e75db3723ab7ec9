#pragma once

#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "app/unique_fd.hpp"

namespace rc10 {

/// Takes SIGTERM, SIGINT and SIGCHLD as something to read. Made before the first thread, so that every
/// thread inherits the blocked signals and none of them dies of one.
class SignalInbox {
 public:
  SignalInbox() noexcept {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGCHLD}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
    fd_ = UniqueFd{::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK)};
  }

  [[nodiscard]] int descriptor() const noexcept { return fd_.get(); }

  /// The next signal that has come, or 0.
  [[nodiscard]] int take() noexcept {
    signalfd_siginfo info{};
    return ::read(fd_.get(), &info, sizeof info) == sizeof info ? static_cast<int>(info.ssi_signo) : 0;
  }

 private:
  UniqueFd fd_;
};

}  // namespace rc10
