#include "daemon/rt_process.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "app/preempt_rt.hpp"
#include "app/sanitizers.hpp"
#include "app/whole_file.hpp"

namespace rc10 {
namespace {

// spdlog formats on its thread: small, but not tiny. The default is 8 MiB.
constexpr std::size_t kLibraryStackBytes = std::size_t{128} * 1024;

}  // namespace

void configureMemory() noexcept {
  // Measured on glibc 2.36: with per-thread arenas four idle threads lock 297 MB, with one arena and
  // small stacks 3.5 MB.
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kLibraryStackBytes);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
}

Result<void> lockMemory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  const int error = errno;
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  return fail(fmt::format(
      "memory could not be locked ({}): RLIMIT_MEMLOCK is {} KiB. Run under systemd with "
      "LimitMEMLOCK=infinity, "
      "or add `YOUR_NAME - memlock unlimited` to a file in /etc/security/limits.d/, or run as root",
      std::strerror(error), limit.rlim_cur / 1024));
}

UniqueFd holdCpuDmaLatency() noexcept {
  UniqueFd fd{::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC)};
  const std::int32_t latency_us = 0;
  if (fd && ::write(fd.get(), &latency_us, sizeof latency_us) != sizeof latency_us) fd.reset();
  return fd;
}

void forbidDumps() noexcept {
  if (!kSanitized) (void)::prctl(PR_SET_DUMPABLE, 0);  // LeakSanitizer traces its own process
}

bool kernelIsPreemptRt() {
  return isPreemptRt(readWholeFile("/sys/kernel/realtime").value_or(""),
                     readWholeFile("/proc/sys/kernel/version").value_or(""));
}

std::uint64_t pageFaults(int tid) noexcept {
  std::array<char, 64> path{};
  std::snprintf(path.data(), path.size(), "/proc/self/task/%d/stat", tid);
  const UniqueFd fd{::open(path.data(), O_RDONLY | O_CLOEXEC)};
  std::array<char, 1024> text{};
  if (!fd || ::read(fd.get(), text.data(), text.size() - 1) <= 0) return 0;
  // proc(5): the name in parentheses may hold anything; after it come state and 6 fields, then minflt
  // cminflt majflt.
  const char* after_name = std::strrchr(text.data(), ')');
  unsigned long minor = 0;
  unsigned long major = 0;
  if (after_name == nullptr ||
      std::sscanf(after_name + 1, " %*c %*d %*d %*d %*d %*d %*u %lu %*u %lu", &minor, &major) != 2) {
    return 0;
  }
  return minor + major;
}

UniqueFd openSchedstat(int tid) noexcept {
  std::array<char, 64> path{};
  std::snprintf(path.data(), path.size(), "/proc/self/task/%d/schedstat", tid);
  return UniqueFd{::open(path.data(), O_RDONLY | O_CLOEXEC)};
}

std::optional<Duration> waitedForCpu(const UniqueFd& schedstat) noexcept {
  std::array<char, 128> text{};
  if (!schedstat || ::pread(schedstat.get(), text.data(), text.size() - 1, 0) <= 0) return std::nullopt;
  // Documentation/scheduler/sched-stats.rst: ns on the CPU, ns ready and waiting, times on the CPU.
  long long waited_ns = 0;
  if (std::sscanf(text.data(), "%*u %lld", &waited_ns) != 1) return std::nullopt;
  return Duration{waited_ns};
}

}  // namespace rc10
