#include "gateway/sandbox.hpp"

#include <grp.h>
#include <linux/capability.h>
#include <linux/netlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
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

struct FileCloser {
  void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
};

// Read from the file: getpwnam() would load modules of NSS.
std::optional<uid_t> idOfUser(const std::string& name) {
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen("/etc/passwd", "re"));
  if (!file) return std::nullopt;
  while (const passwd* entry = ::fgetpwent(file.get()))
    if (entry->pw_name == name) return entry->pw_uid;
  return std::nullopt;
}

// Rights of root; without a user of its own, `nobody`, who owns no file.
Result<void> leaveRoot() {
  if (::geteuid() != 0) return {};
  constexpr const char* kUser = "rc10-lcm";
  constexpr uid_t kNobody = 65534;
  const auto user = idOfUser(kUser).value_or(kNobody);
  if (::setgroups(0, nullptr) == 0 && ::setresgid(user, user, user) == 0 &&
      ::setresuid(user, user, user) == 0)
    return {};
  // In a user namespace without other users root is an ordinary user of the computer.
  return errno == EINVAL || errno == EPERM ? Result<void>{} : notDropped("user", errno);
}

// All that libc and the gateway call from here on, on any architecture: libseccomp leaves out those that this
// one has not. None opens a file, starts a program, or names another process.
constexpr std::array kAllowed{SCMP_SYS(brk),
                              SCMP_SYS(clock_gettime),
                              SCMP_SYS(clock_gettime64),
                              SCMP_SYS(close),
                              SCMP_SYS(exit),
                              SCMP_SYS(exit_group),
                              SCMP_SYS(fstat),
                              SCMP_SYS(fstat64),
                              SCMP_SYS(futex),
                              SCMP_SYS(futex_time64),
                              SCMP_SYS(getpid),
                              SCMP_SYS(getppid),
                              SCMP_SYS(getrandom),
                              SCMP_SYS(gettid),
                              SCMP_SYS(gettimeofday),
                              SCMP_SYS(madvise),
                              SCMP_SYS(mremap),
                              SCMP_SYS(munmap),
                              SCMP_SYS(poll),
                              SCMP_SYS(ppoll),
                              SCMP_SYS(ppoll_time64),
                              SCMP_SYS(read),
                              SCMP_SYS(recv),
                              SCMP_SYS(recvfrom),
                              SCMP_SYS(recvmsg),
                              SCMP_SYS(restart_syscall),
                              SCMP_SYS(rt_sigaction),
                              SCMP_SYS(rt_sigprocmask),
                              SCMP_SYS(rt_sigreturn),
                              SCMP_SYS(send),
                              SCMP_SYS(sendmsg),
                              SCMP_SYS(sendto),
                              SCMP_SYS(sigreturn),
                              SCMP_SYS(write),
                              SCMP_SYS(writev)};

// The sanitizers' own: they start threads, read files of /proc and trace this very process.
constexpr std::array kAllowedToSanitizers{
    SCMP_SYS(clone),       SCMP_SYS(getdents64),  SCMP_SYS(openat),     SCMP_SYS(prctl),
    SCMP_SYS(ptrace),      SCMP_SYS(readlink),    SCMP_SYS(readlinkat), SCMP_SYS(sched_getaffinity),
    SCMP_SYS(sched_yield), SCMP_SYS(sigaltstack), SCMP_SYS(wait4),      SCMP_SYS(getrlimit),
    SCMP_SYS(prlimit64),   SCMP_SYS(newfstatat),  SCMP_SYS(lseek),      SCMP_SYS(set_robust_list)};

/// Rules of one filter; the first error stays.
class Filter {
 public:
  // A call that is not allowed fails like one without the right, so that a libc of another version than the
  // tested one loses a message and not the gateway.
  Filter() : context_(seccomp_init(SCMP_ACT_ERRNO(EACCES))), status_(context_ == nullptr ? -ENOMEM : 0) {}
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;
  ~Filter() { seccomp_release(context_); }

  template <typename... Conditions>
  void allow(int call, Conditions... conditions) {
    if (status_ == 0)
      status_ = seccomp_rule_add(context_, SCMP_ACT_ALLOW, call, sizeof...(conditions), conditions...);
  }
  int load() {
    if (status_ == 0) status_ = seccomp_load(context_);
    return status_;
  }

 private:
  scmp_filter_ctx context_;
  int status_;
};

// An argument that the kernel takes for 32 bits is compared as 32 bits: the upper half may be anything.
scmp_arg_cmp argument(unsigned place, std::uint32_t value, std::uint32_t mask = ~std::uint32_t{0}) {
  return {.arg = place, .op = SCMP_CMP_MASKED_EQ, .datum_a = mask, .datum_b = value};
}

// The kinds of LCM and of the question for its route. The kernel takes flags out of the type.
void allowSockets(Filter& filter) {
  constexpr std::uint32_t kTypeMask = 0xF;
  filter.allow(SCMP_SYS(socket), argument(0, AF_INET), argument(1, SOCK_DGRAM, kTypeMask), argument(2, 0));
  filter.allow(SCMP_SYS(socket), argument(0, AF_NETLINK), argument(1, SOCK_RAW, kTypeMask),
               argument(2, NETLINK_ROUTE));
  filter.allow(SCMP_SYS(bind));
  filter.allow(SCMP_SYS(setsockopt), argument(1, SOL_SOCKET));
  filter.allow(SCMP_SYS(setsockopt), argument(1, IPPROTO_IP));
  filter.allow(SCMP_SYS(ioctl), argument(1, SIOCGIFNAME));
}

Result<void> filterSystemCalls() {
  Filter filter;
  for (const int call : kAllowed) filter.allow(call);
  if (kSanitized)
    for (const int call : kAllowedToSanitizers) filter.allow(call);
  allowSockets(filter);
  // Memory that is no code; of sanitizers' code, neither.
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mmap2), SCMP_SYS(mprotect)})
    filter.allow(call, argument(2, 0, PROT_EXEC));
  // abort(): at nobody else.
  filter.allow(SCMP_SYS(tgkill), argument(0, static_cast<std::uint32_t>(::getpid())));
  const int status = filter.load();
  return status == 0 ? Result<void>{} : notDropped("seccomp", -status);
}

}  // namespace

Result<void> enterSandbox(int parent) {
  firstToDie();
  // Last that needs /proc/self, which root owns from here on. LeakSanitizer traces its own process.
  if (!kSanitized && ::prctl(PR_SET_DUMPABLE, 0) != 0) return notDropped("PR_SET_DUMPABLE", errno);
  if (auto result = leaveRealTime(); !result) return result;
  if (auto result = limitResources(); !result) return result;
  if (auto result = leaveRoot(); !result) return result;
  if (auto result = dropCapabilities(); !result) return result;
  if (::getppid() == parent) {
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);  // after the capabilities: changing them may clear it
    if (::getppid() != parent) return fail("rc10d has ended");
  }
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return notDropped("PR_SET_NO_NEW_PRIVS", errno);
  return filterSystemCalls();
}

}  // namespace rc10::gateway
