#include "latency_test.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "app/timespec.hpp"
#include "app/unique_fd.hpp"
#include "session.hpp"

namespace rc10::ctl {
namespace {

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

MonotonicTime now() noexcept { return std::chrono::steady_clock::now(); }

}  // namespace

doctor::LatencyFacts measureLatency(const LatencyTest& test, doctor::LatencyHistogram& histogram) {
  doctor::LatencyFacts facts;
  facts.period = test.grid.period;
  facts.by = "the latency test";
  {
    const AsScheduler as_scheduler(test);
    facts.refused = as_scheduler.refused();
    facts.realtime = facts.refused.empty();
    MonotonicTime next = test.grid.next(now());
    for (const MonotonicTime end = next + test.time; next < end && !interrupted();) {
      const timespec wanted = toTimespec(next.time_since_epoch());
      if (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wanted, nullptr) != 0) continue;  // a signal
      const Duration late = now() - next;
      histogram.record(late);
      // Points that were missed are skipped, as in rc10d.
      next += (late / test.grid.period + 1) * test.grid.period;
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
