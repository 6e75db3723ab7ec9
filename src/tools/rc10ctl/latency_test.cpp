#include "latency_test.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "app/unique_fd.hpp"
#include "session.hpp"

namespace rc10::ctl {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

// Settings of rc10d's scheduler thread for the life of the object; those without permission are left out.
class AsScheduler {
 public:
  explicit AsScheduler(const LatencyTest& test) {
    ::mlockall(MCL_CURRENT | MCL_FUTURE);
    dma_latency_ = UniqueFd{::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC)};
    const std::int32_t none_us = 0;
    if (dma_latency_ && ::write(dma_latency_.get(), &none_us, sizeof none_us) < 0) dma_latency_.reset();
    ::sched_getaffinity(0, sizeof cpus_, &cpus_);
    if (test.cpu) {
      cpu_set_t one;
      CPU_ZERO(&one);
      CPU_SET(static_cast<std::size_t>(*test.cpu), &one);
      ::sched_setaffinity(0, sizeof one, &one);
    }
    const sched_param fifo{.sched_priority = test.priority};
    if (::sched_setscheduler(0, SCHED_FIFO, &fifo) != 0) refused_ = std::strerror(errno);
  }
  ~AsScheduler() {
    const sched_param none{};
    ::sched_setscheduler(0, SCHED_OTHER, &none);
    ::sched_setaffinity(0, sizeof cpus_, &cpus_);
    ::munlockall();
  }
  AsScheduler(const AsScheduler&) = delete;
  AsScheduler& operator=(const AsScheduler&) = delete;

  [[nodiscard]] const std::string& refused() const noexcept { return refused_; }

 private:
  UniqueFd dma_latency_;
  cpu_set_t cpus_{};
  std::string refused_;
};

std::int64_t now() noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kNsPerSecond + time.tv_nsec;
}

}  // namespace

doctor::LatencyFacts measureLatency(const LatencyTest& test, doctor::LatencyHistogram& histogram) {
  doctor::LatencyFacts facts;
  facts.period = test.period;
  facts.by = "the latency test";
  {
    const AsScheduler as_scheduler(test);
    facts.refused = as_scheduler.refused();
    facts.realtime = facts.refused.empty();
    const std::int64_t period = test.period.count();
    std::int64_t next = (now() / period + 1) * period;
    for (const std::int64_t end = next + test.time.count(); next < end && !interrupted();) {
      const timespec wanted{.tv_sec = next / kNsPerSecond, .tv_nsec = next % kNsPerSecond};
      if (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wanted, nullptr) != 0) continue;  // a signal
      const std::int64_t late = now() - next;
      histogram.record(Duration{late});
      next += (late / period + 1) * period;  // those that were missed are skipped, as in rc10d
    }
  }
  facts.p50 = histogram.percentile(0.5);
  facts.p99 = histogram.percentile(0.99);
  facts.p999 = histogram.percentile(0.999);
  facts.max = histogram.max();
  facts.wake_ups = histogram.count();
  return facts;
}

}  // namespace rc10::ctl
