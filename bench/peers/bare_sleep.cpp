// A loop of 1 kHz that does nothing but sleep to its grid, SCHED_FIFO 60 as rc10d's scheduler: how late a
// thread of its priority wakes on this computer. Until SIGTERM; prints the percentiles as a JSON object.
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <vector>

namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;
constexpr std::int64_t kSecondNs = 1'000 * kPeriodNs;
// Phase: where rc10d's ticks lie.
constexpr std::int64_t kPhaseNs = kPeriodNs * 3 / 10;
constexpr int kPriority = 60;
constexpr std::size_t kMostCycles = 1'000'000;

volatile std::sig_atomic_t ended = 0;

std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kSecondNs + time.tv_nsec;
}

}  // namespace

int main() {
  const sched_param priority{.sched_priority = kPriority};
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0 || mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::perror("bare_sleep");
    return 1;
  }
  std::signal(SIGTERM, [](int) { ended = 1; });
  std::vector<std::int64_t> late_ns(kMostCycles);
  std::size_t cycles = 0;
  std::int64_t due = (now() / kPeriodNs + 2) * kPeriodNs + kPhaseNs;
  while (ended == 0 && cycles < kMostCycles) {
    const timespec until{.tv_sec = due / kSecondNs, .tv_nsec = due % kSecondNs};
    if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) break;
    late_ns[cycles++] = now() - due;
    due += kPeriodNs;
  }
  late_ns.resize(cycles);
  std::sort(late_ns.begin(), late_ns.end());
  if (cycles == 0) return 1;
  std::printf("{\"p50_us\": %.3f, \"p99_us\": %.3f}\n", static_cast<double>(late_ns[cycles / 2]) * 1e-3,
              static_cast<double>(late_ns[cycles * 99 / 100]) * 1e-3);
}
