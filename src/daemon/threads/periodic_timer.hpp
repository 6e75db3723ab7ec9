#pragma once

#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10 {

/// The next multiple of `period` on CLOCK_MONOTONIC that lies at least half a period ahead.
[[nodiscard]] constexpr MonotonicTime nextOnGrid(MonotonicTime now, Duration period) noexcept {
  const auto ahead = now.time_since_epoch() + period / 2;
  return MonotonicTime{(ahead / period + 1) * period};
}

/// A timerfd on an absolute grid of CLOCK_MONOTONIC.
class PeriodicTimer {
 public:
  [[nodiscard]] static Result<PeriodicTimer> create() {
    UniqueFd fd{timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC)};
    if (!fd) return fail(std::string("timerfd_create: ") + std::strerror(errno));
    return PeriodicTimer{std::move(fd)};
  }

  /// Expires at `first` and then every `period`.
  void start(MonotonicTime first, Duration period) noexcept {
    const itimerspec spec{.it_interval = split(period), .it_value = split(first.time_since_epoch())};
    timerfd_settime(fd_.get(), TFD_TIMER_ABSTIME, &spec, nullptr);
  }

  /// Waits for the next expiration. Returns how many came since the last wait: above 1, some were
  /// missed. 0: interrupted.
  [[nodiscard]] std::uint64_t wait() noexcept {
    std::uint64_t expirations = 0;
    return ::read(fd_.get(), &expirations, sizeof expirations) == sizeof expirations ? expirations : 0;
  }

 private:
  explicit PeriodicTimer(UniqueFd fd) : fd_(std::move(fd)) {}

  [[nodiscard]] static timespec split(Duration duration) noexcept {
    constexpr std::int64_t kNsPerSecond = 1'000'000'000;
    return {.tv_sec = duration.count() / kNsPerSecond, .tv_nsec = duration.count() % kNsPerSecond};
  }

  UniqueFd fd_;
};

}  // namespace rc10
