#include "sandbox/system_calls.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>

#include "app/sanitizers.hpp"
#include "sandbox/rights.hpp"

namespace rc10::sandbox {

SystemCalls::SystemCalls()
    : context_(seccomp_init(SCMP_ACT_ERRNO(EACCES))), status_(context_ == nullptr ? -ENOMEM : 0) {
  allow({SCMP_SYS(brk),
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
         SCMP_SYS(writev)});
  // The sanitizers' own: they start threads, read files of /proc and trace this very process.
  if (kSanitized)
    allow({SCMP_SYS(clone), SCMP_SYS(getdents64), SCMP_SYS(openat), SCMP_SYS(prctl), SCMP_SYS(ptrace),
           SCMP_SYS(readlink), SCMP_SYS(readlinkat), SCMP_SYS(sched_getaffinity), SCMP_SYS(sched_yield),
           SCMP_SYS(sigaltstack), SCMP_SYS(wait4), SCMP_SYS(getrlimit), SCMP_SYS(prlimit64),
           SCMP_SYS(newfstatat), SCMP_SYS(lseek), SCMP_SYS(set_robust_list)});
  // Memory that is no code; of sanitizers' code, neither.
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mmap2), SCMP_SYS(mprotect)})
    allow(call, argument(2, 0, PROT_EXEC));
  // abort(): at nobody else.
  allow(SCMP_SYS(tgkill), argument(0, static_cast<std::uint32_t>(::getpid())));
}

SystemCalls::~SystemCalls() { seccomp_release(context_); }

void SystemCalls::allow(std::initializer_list<int> calls) {
  for (const int call : calls) allow(call);
}

Result<void> SystemCalls::keepToThese() {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return notDropped("PR_SET_NO_NEW_PRIVS", errno);
  if (status_ == 0) status_ = seccomp_load(context_);
  return status_ == 0 ? Result<void>{} : notDropped("seccomp", -status_);
}

}  // namespace rc10::sandbox
