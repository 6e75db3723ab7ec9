#include "daemon/threads/periodic_timer.hpp"

#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "app/errno_text.hpp"
#include "app/timespec.hpp"
#include "daemon/exchange/clock.hpp"

namespace rc10 {

Result<PeriodicTimer> PeriodicTimer::create(TimerKind kind) {
  if (kind == TimerKind::kNanosleep) return PeriodicTimer{UniqueFd{}};
  UniqueFd fd{timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC)};
  if (!fd) return fail(std::string("timerfd_create: ") + errnoText(errno));
  return PeriodicTimer{std::move(fd)};
}

void PeriodicTimer::start(MonotonicTime first, Duration period) noexcept {
  next_ = first;
  period_ = period;
  if (!fd_) return;
  const itimerspec spec{.it_interval = toTimespec(period), .it_value = toTimespec(first.time_since_epoch())};
  if (timerfd_settime(fd_.get(), TFD_TIMER_ABSTIME, &spec, nullptr) != 0) fd_.reset();
}

std::uint64_t PeriodicTimer::wait() noexcept {
  if (!fd_) return sleep();
  std::uint64_t expirations = 0;
  if (::read(fd_.get(), &expirations, sizeof expirations) == sizeof expirations) {
    woken_ = monotonicNow();
    next_ += period_ * static_cast<std::int64_t>(expirations);
    return expirations;
  }
  // A timer that cannot be read would make a FIFO thread spin: from now on it sleeps on the same grid.
  if (errno != EINTR) fd_.reset();
  return 0;
}

std::uint64_t PeriodicTimer::sleep() noexcept {
  const timespec until = toTimespec(next_.time_since_epoch());
  if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) return 0;
  woken_ = monotonicNow();
  const auto expirations = (woken_ - next_) / period_ + 1;
  next_ += period_ * expirations;
  return static_cast<std::uint64_t>(expirations);
}

}  // namespace rc10
