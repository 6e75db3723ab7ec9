#include "sandbox/rights.hpp"

#include <linux/capability.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "app/sanitizers.hpp"

namespace rc10::sandbox {
namespace {

Result<void> limitResources(const Bounds& bounds) {
  struct Limit {
    __rlimit_resource resource;
    rlim_t value;
    const char* name;
  };
  const std::array limits{
      Limit{RLIMIT_RTPRIO, 0, "RLIMIT_RTPRIO"},
      Limit{RLIMIT_NICE, 0, "RLIMIT_NICE"},
      Limit{RLIMIT_MEMLOCK, 64 << 10, "RLIMIT_MEMLOCK"},
      Limit{RLIMIT_NOFILE, bounds.files, "RLIMIT_NOFILE"},
      Limit{RLIMIT_DATA, bounds.memory_bytes, "RLIMIT_DATA"},
      Limit{RLIMIT_AS, bounds.memory_bytes, "RLIMIT_AS"},
  };
  for (const auto& [resource, value, name] : limits) {
    // Shadow memory needs more.
    if (kSanitized && (resource == RLIMIT_DATA || resource == RLIMIT_AS)) continue;
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0) return notDropped(name, errno);
    limit.rlim_max = limit.rlim_max < value ? limit.rlim_max : value;
    limit.rlim_cur = limit.rlim_cur < limit.rlim_max ? limit.rlim_cur : limit.rlim_max;
    if (::setrlimit(resource, &limit) != 0) return notDropped(name, errno);
  }
  return {};
}

Result<void> leaveRealTime() {
  // The unit of rc10-web has not even the call.
  if (::sched_getscheduler(0) == SCHED_OTHER) return {};
  const sched_param ordinary{};
  if (::sched_setscheduler(0, SCHED_OTHER, &ordinary) != 0) return notDropped("SCHED_OTHER", errno);
  return {};
}

// Where /proc is closed it cannot be said.
void dieFirst() {
  if (std::FILE* file = std::fopen("/proc/self/oom_score_adj", "we")) {
    std::fputs("500", file);
    std::fclose(file);
  }
}

}  // namespace

tl::unexpected<Error> notDropped(const std::string& what, int error) {
  return fail("cannot drop privileges: " + what + ": " + std::strerror(error));
}

Result<void> bound(const Bounds& bounds) {
  dieFirst();
  // Last that needs /proc/self, which root owns from here on. LeakSanitizer traces its own process.
  if (!kSanitized && ::prctl(PR_SET_DUMPABLE, 0) != 0) return notDropped("PR_SET_DUMPABLE", errno);
  if (auto result = leaveRealTime(); !result) return result;
  return limitResources(bounds);
}

Result<void> dropCapabilities(std::uint64_t kept) {
  (void)::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  __user_cap_header_struct header{};
  header.version = _LINUX_CAPABILITY_VERSION_3;
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
  if (::syscall(SYS_capget, &header, sets.data()) != 0) return notDropped("capget", errno);
  std::uint32_t had = 0;
  for (auto& set : sets) {
    had |= set.permitted | set.inheritable;
    set.effective = set.permitted = set.effective & static_cast<std::uint32_t>(kept);
    set.inheritable = 0;
    kept >>= 32U;
  }
  if (had == 0) return {};
  if (::syscall(SYS_capset, &header, sets.data()) != 0) return notDropped("capset", errno);
  return {};
}

}  // namespace rc10::sandbox
