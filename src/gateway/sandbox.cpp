#include "gateway/sandbox.hpp"

#include <linux/capability.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include "app/sanitizers.hpp"

namespace rc10::gateway {
namespace {

constexpr rlim_t kMaxMemory = rlim_t{256} << 20U;

Result<void> notDropped(const std::string& what, int error) {
  return fail("cannot drop privileges: " + what + ": " + std::strerror(error));
}

Result<void> limitResources() {
  struct Limit {
    __rlimit_resource resource;
    rlim_t value;
    const char* name;
  };
  constexpr std::array kLimits{
      Limit{RLIMIT_RTPRIO, 0, "RLIMIT_RTPRIO"},          Limit{RLIMIT_NICE, 0, "RLIMIT_NICE"},
      Limit{RLIMIT_MEMLOCK, 64 << 10, "RLIMIT_MEMLOCK"}, Limit{RLIMIT_NOFILE, 32, "RLIMIT_NOFILE"},
      Limit{RLIMIT_DATA, kMaxMemory, "RLIMIT_DATA"},     Limit{RLIMIT_AS, kMaxMemory, "RLIMIT_AS"},
  };
  for (const auto& [resource, value, name] : kLimits) {
    // Shadow memory needs more.
    if (kSanitized && (resource == RLIMIT_DATA || resource == RLIMIT_AS)) continue;
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0) return notDropped(name, errno);
    // A limit that is lower already stays.
    limit.rlim_max = limit.rlim_max < value ? limit.rlim_max : value;
    limit.rlim_cur = limit.rlim_cur < limit.rlim_max ? limit.rlim_cur : limit.rlim_max;
    if (::setrlimit(resource, &limit) != 0) return notDropped(name, errno);
  }
  return {};
}

Result<void> dropCapabilities() {
  (void)::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  __user_cap_header_struct header{};
  header.version = _LINUX_CAPABILITY_VERSION_3;
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> none{};
  if (::syscall(SYS_capset, &header, none.data()) != 0) return notDropped("capset", errno);
  return {};
}

Result<void> leaveRealTime() {
  const sched_param ordinary{};
  if (::sched_setscheduler(0, SCHED_OTHER, &ordinary) != 0) return notDropped("SCHED_OTHER", errno);
  return {};
}

void firstToDie() {
  // Under memory pressure the gateway goes before rc10d does. Where /proc is closed it cannot be said.
  if (std::FILE* file = std::fopen("/proc/self/oom_score_adj", "we")) {
    std::fputs("500", file);
    std::fclose(file);
  }
}

// Denies a system call, or one with a given first argument. 0, or a negative errno.
int deny(scmp_filter_ctx filter, int call) {
  return seccomp_rule_add(filter, SCMP_ACT_ERRNO(EACCES), call, 0);
}
int denyFamily(scmp_filter_ctx filter, int family) {
  const scmp_arg_cmp is_family{
      .arg = 0, .op = SCMP_CMP_EQ, .datum_a = static_cast<scmp_datum_t>(family), .datum_b = 0};
  return seccomp_rule_add(filter, SCMP_ACT_ERRNO(EACCES), SCMP_SYS(socket), 1, is_family);
}

Result<void> filterSystemCalls() {
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  if (filter == nullptr) return notDropped("seccomp", ENOMEM);
  int status = 0;
  for (const int family : {AF_CAN, AF_PACKET, AF_VSOCK, AF_ALG, AF_BLUETOOTH}) {
    if (status == 0) status = denyFamily(filter, family);
  }
  // io_uring makes sockets without socket(). The others start programs, reach into other processes or
  // take a priority.
  for (const int call : {SCMP_SYS(io_uring_setup), SCMP_SYS(execve), SCMP_SYS(execveat),
                         SCMP_SYS(process_vm_writev), SCMP_SYS(sched_setattr), SCMP_SYS(sched_setparam),
                         SCMP_SYS(sched_setscheduler), SCMP_SYS(pidfd_getfd)}) {
    if (status == 0) status = deny(filter, call);
  }
  if (status == 0 && !kSanitized) status = deny(filter, SCMP_SYS(ptrace));
  if (status == 0) status = seccomp_load(filter);
  seccomp_release(filter);
  return status == 0 ? Result<void>{} : notDropped("seccomp", -status);
}

}  // namespace

Result<void> enterSandbox(int parent) {
  firstToDie();
  // Last that needs /proc/self, which root owns from here on. LeakSanitizer traces its own process.
  if (!kSanitized && ::prctl(PR_SET_DUMPABLE, 0) != 0) return notDropped("PR_SET_DUMPABLE", errno);
  if (auto result = leaveRealTime(); !result) return result;
  if (auto result = limitResources(); !result) return result;
  if (auto result = dropCapabilities(); !result) return result;
  if (::getppid() == parent) {
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);  // after the capabilities: changing them may clear it
    if (::getppid() != parent) return fail("rc10d has ended");
  }
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return notDropped("PR_SET_NO_NEW_PRIVS", errno);
  return filterSystemCalls();
}

}  // namespace rc10::gateway
