#include "web/sandbox.hpp"

#include <fcntl.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <csignal>
#include <cstdint>

#include "sandbox/file_view.hpp"
#include "sandbox/rights.hpp"
#include "sandbox/system_calls.hpp"

namespace rc10::web {
namespace {

// Descriptors: 64 pages, each with its connection, two to rc10d and a recording. The service's own bound of
// memory is lower, and holds its share of the kernel's as well.
constexpr sandbox::Bounds kBounds{.memory_bytes = rlim_t{192} << 20U, .files = 512};

void allowServing(sandbox::SystemCalls& calls) {
  using sandbox::argument;
  calls.allow({SCMP_SYS(accept), SCMP_SYS(accept4), SCMP_SYS(epoll_ctl), SCMP_SYS(epoll_pwait),
               SCMP_SYS(epoll_wait), SCMP_SYS(getpeername), SCMP_SYS(getsockname), SCMP_SYS(getsockopt),
               SCMP_SYS(readv), SCMP_SYS(setsockopt), SCMP_SYS(shutdown), SCMP_SYS(timerfd_settime),
               SCMP_SYS(timerfd_settime64)});
  calls.allow(SCMP_SYS(ioctl), argument(1, FIONBIO));
}

// Its socket and that of the e-stop; a pause while it does not answer.
void allowRc10d(sandbox::SystemCalls& calls) {
  using sandbox::argument;
  constexpr std::uint32_t kTypeMask = 0xF;  // the kernel takes flags out of the type
  for (const std::uint32_t type : {SOCK_SEQPACKET, SOCK_DGRAM})
    calls.allow(SCMP_SYS(socket), argument(0, AF_UNIX), argument(1, type, kTypeMask), argument(2, 0));
  calls.allow(
      {SCMP_SYS(connect), SCMP_SYS(clock_nanosleep), SCMP_SYS(clock_nanosleep_time64), SCMP_SYS(nanosleep)});
}

// A process for a page's text or curve, which has no more than this one and bounds itself
// (bounded_child.cpp). No thread, no program, and no signal to anybody.
void allowChildren(sandbox::SystemCalls& calls) {
  using sandbox::argument;
  constexpr std::uint32_t kFork = CLONE_CHILD_CLEARTID | CLONE_CHILD_SETTID | SIGCHLD;  // fork() of glibc
  calls.allow(SCMP_SYS(clone), argument(0, kFork));
  calls.allow(SCMP_SYS(prctl), argument(0, PR_SET_PDEATHSIG));
  calls.allow(SCMP_SYS(prlimit64), argument(0, 0));  // its own
  calls.allow({SCMP_SYS(alarm), SCMP_SYS(close_range), SCMP_SYS(pipe2), SCMP_SYS(set_robust_list),
               SCMP_SYS(setitimer), SCMP_SYS(wait4)});
}

// Folders of rc10d and its recordings.
void allowReading(sandbox::SystemCalls& calls) {
  using sandbox::argument;
  constexpr std::uint32_t kWrites = O_ACCMODE | O_CREAT | O_TRUNC | O_APPEND | (O_TMPFILE & ~O_DIRECTORY);
  calls.allow(SCMP_SYS(openat), argument(2, O_RDONLY, kWrites));
  calls.allow(SCMP_SYS(open), argument(1, O_RDONLY, kWrites));
  calls.allow({SCMP_SYS(_llseek), SCMP_SYS(fstatat64), SCMP_SYS(getdents), SCMP_SYS(getdents64),
               SCMP_SYS(lseek), SCMP_SYS(lstat), SCMP_SYS(lstat64), SCMP_SYS(newfstatat), SCMP_SYS(pread64),
               SCMP_SYS(stat), SCMP_SYS(stat64), SCMP_SYS(statx)});
  // F_SETOWN would send signals to others.
  for (const int order : {F_GETFD, F_SETFD, F_GETFL, F_SETFL})
    for (const int call : {SCMP_SYS(fcntl), SCMP_SYS(fcntl64)})
      calls.allow(call, argument(1, static_cast<std::uint32_t>(order)));
}

}  // namespace

Result<void> enterSandbox(const std::vector<std::string>& folders) {
  if (auto result = sandbox::bound(kBounds); !result) return result;
  // Started by root, it speaks to an rc10d that has another user.
  if (auto result = sandbox::dropCapabilities(std::uint64_t{1} << unsigned{CAP_DAC_OVERRIDE}); !result)
    return result;
  if (auto result = sandbox::readOnlyBeside(folders); !result) return result;
  sandbox::SystemCalls calls;
  allowServing(calls);
  allowRc10d(calls);
  allowReading(calls);
  allowChildren(calls);
  return calls.keepToThese();
}

}  // namespace rc10::web
