#pragma once

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "app/whole_file.hpp"

/// Ways out of a sandbox, tried from inside.
namespace rc10::test::escapes {

using Enter = std::function<Result<void>()>;

struct Escape {
  const char* name;
  std::function<long()> attempt;
};
using Escapes = std::vector<Escape>;

/// A child that has entered the sandbox runs this: there is no way back out of it. Its status.
inline int statusInSandbox(const Enter& enter, const std::function<bool()>& check) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto entered = enter();
    if (!entered) std::fprintf(stderr, "%s\n", entered.error().message.c_str());
    ::_exit(entered && check() ? 0 : 1);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

inline void inSandbox(const Enter& enter, const std::function<bool()>& check) {
  const int status = statusInSandbox(enter, check);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "status " << status;
}

/// One after the other, from inside; each that is not refused by the list is named.
inline void expectRefused(const Enter& enter, const Escapes& escapes) {
  inSandbox(enter, [&] {
    bool all = true;
    for (const auto& [name, attempt] : escapes) {
      errno = 0;
      const long result = attempt();
      if (result == -1 && errno == EACCES) continue;
      std::fprintf(stderr, "%s: %ld, errno %d\n", name, result, errno);
      all = false;
    }
    return all;
  });
}

/// 0: there is one.
inline int socketError(long family, long type, long protocol = 0) {
  errno = 0;
  const UniqueFd socket{static_cast<int>(::syscall(SYS_socket, family, type, protocol))};
  return socket ? 0 : errno;
}

/// All but those of `has`.
inline bool hasNoOtherSockets(const std::function<bool(long family, long type)>& has) {
  bool none = true;
  for (long family = 0; family < AF_MAX + 2; ++family)
    for (const long type : {SOCK_STREAM, SOCK_DGRAM, SOCK_RAW, SOCK_SEQPACKET, SOCK_PACKET})
      none = none && (has(family, type) || socketError(family, type) == EACCES);
  return none;
}

/// `other`: another process.
inline Escapes toOtherProcesses(pid_t other) {
  static int value = 0;
  static const iovec here{.iov_base = &value, .iov_len = sizeof value};
  return {
      {"kill", [=] { return ::syscall(SYS_kill, other, 0L); }},
      {"tgkill", [=] { return ::syscall(SYS_tgkill, other, other, 0L); }},
      {"tkill", [=] { return ::syscall(SYS_tkill, other, 0L); }},
      {"rt_sigqueueinfo", [=] { return ::syscall(SYS_rt_sigqueueinfo, other, SIGTERM, nullptr); }},
      {"rt_tgsigqueueinfo", [=] { return ::syscall(SYS_rt_tgsigqueueinfo, other, other, SIGTERM, nullptr); }},
      {"pidfd_open", [=] { return ::syscall(SYS_pidfd_open, other, 0L); }},
      {"pidfd_send_signal", [] { return ::syscall(SYS_pidfd_send_signal, 0L, 0L, nullptr, 0L); }},
      {"pidfd_getfd", [] { return ::syscall(SYS_pidfd_getfd, 0L, 0L, 0L); }},
      {"ptrace", [=] { return ::syscall(SYS_ptrace, PTRACE_SEIZE, other, 0L, 0L); }},
      {"process_vm_readv", [=] { return ::syscall(SYS_process_vm_readv, other, &here, 1L, &here, 1L, 0L); }},
      {"process_vm_writev",
       [=] { return ::syscall(SYS_process_vm_writev, other, &here, 1L, &here, 1L, 0L); }},
      {"process_madvise", [] { return ::syscall(SYS_process_madvise, 0L, nullptr, 0L, 0L, 0L); }},
      {"kcmp", [=] { return ::syscall(SYS_kcmp, other, other, 0L, 0L, 0L); }},
      {"prlimit64", [=] { return ::syscall(SYS_prlimit64, other, RLIMIT_RTPRIO, nullptr, nullptr); }},
      {"setpriority", [=] { return ::syscall(SYS_setpriority, PRIO_PROCESS, other, 19L); }},
      {"sched_setscheduler", [=] { return ::syscall(SYS_sched_setscheduler, other, 0L, nullptr); }},
      {"sched_setparam", [=] { return ::syscall(SYS_sched_setparam, other, nullptr); }},
      {"sched_setattr", [=] { return ::syscall(SYS_sched_setattr, other, nullptr, 0L); }},
      {"sched_setaffinity", [=] { return ::syscall(SYS_sched_setaffinity, other, 0L, nullptr); }},
      {"ioprio_set", [=] { return ::syscall(SYS_ioprio_set, 1L, other, 0L); }},
      {"migrate_pages", [=] { return ::syscall(SYS_migrate_pages, other, 0L, nullptr, nullptr); }},
      {"perf_event_open", [=] { return ::syscall(SYS_perf_event_open, nullptr, other, -1L, -1L, 0L); }},
  };
}

inline Escapes byFiles(pid_t other) {
  const std::string memory = "/proc/" + std::to_string(other) + "/mem";
  return {
      {"openat to write", [=] { return ::syscall(SYS_openat, AT_FDCWD, memory.c_str(), O_RDWR); }},
      {"openat2", [] { return ::syscall(SYS_openat2, AT_FDCWD, "/dev/null", nullptr, 0L); }},
      {"open_by_handle_at", [] { return ::syscall(SYS_open_by_handle_at, AT_FDCWD, nullptr, 0L); }},
      {"memfd_create", [] { return ::syscall(SYS_memfd_create, "x", 0L); }},
      {"unlinkat", [] { return ::syscall(SYS_unlinkat, AT_FDCWD, "/no/such", 0L); }},
      {"renameat2", [] { return ::syscall(SYS_renameat2, AT_FDCWD, "/no", AT_FDCWD, "/such", 0L); }},
      {"symlinkat", [] { return ::syscall(SYS_symlinkat, "/no", AT_FDCWD, "/such"); }},
      {"linkat", [] { return ::syscall(SYS_linkat, AT_FDCWD, "/no", AT_FDCWD, "/such", 0L); }},
      {"mkdirat", [] { return ::syscall(SYS_mkdirat, AT_FDCWD, "/no/such", 0L); }},
      {"fchmodat", [] { return ::syscall(SYS_fchmodat, AT_FDCWD, "/no/such", 0L); }},
      {"fchownat", [] { return ::syscall(SYS_fchownat, AT_FDCWD, "/no/such", 0L, 0L, 0L); }},
      {"truncate", [] { return ::syscall(SYS_truncate, "/no/such", 0L); }},
      {"ftruncate", [] { return ::syscall(SYS_ftruncate, 0L, 0L); }},
      {"mknodat", [] { return ::syscall(SYS_mknodat, AT_FDCWD, "/no/such", 0L, 0L); }},
      {"dup3", [] { return ::syscall(SYS_dup3, 0L, 9L, 0L); }},
      {"tty", [] { return ::syscall(SYS_ioctl, 0L, TIOCSTI, "x"); }},
  };
}

inline Escapes byPrograms() {
  static char name[] = "/bin/true";
  static char* argv[] = {name, nullptr};
  return {
      {"execve", [] { return ::syscall(SYS_execve, name, argv, nullptr); }},
      {"execveat", [] { return ::syscall(SYS_execveat, AT_FDCWD, name, argv, nullptr, 0L); }},
      {"clone", [] { return ::syscall(SYS_clone, SIGCHLD, 0L, 0L, 0L, 0L); }},
      {"clone3", [] { return ::syscall(SYS_clone3, nullptr, 0L); }},
#ifdef SYS_fork  // not on arm64
      {"fork", [] { return ::syscall(SYS_fork); }},
      {"open to write", [] { return ::syscall(SYS_open, "/dev/null", O_RDWR); }},
      {"creat", [] { return ::syscall(SYS_creat, "/no/such", 0L); }},
#endif
      {"mmap of code",
       [] {
         return ::syscall(SYS_mmap, 0L, 4096L, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1L, 0L);
       }},
      {"mprotect of code", [] { return ::syscall(SYS_mprotect, 0L, 0L, PROT_EXEC); }},
      {"pkey_mprotect", [] { return ::syscall(SYS_pkey_mprotect, 0L, 0L, PROT_EXEC, -1L); }},
      {"remap_file_pages", [] { return ::syscall(SYS_remap_file_pages, 0L, 0L, 0L, 0L, 0L); }},
      {"personality", [] { return ::syscall(SYS_personality, 0x0400000L); }},
  };
}

inline Escapes byTheKernel() {
  return {
      {"io_uring_setup", [] { return ::syscall(SYS_io_uring_setup, 8L, nullptr); }},
      {"bpf", [] { return ::syscall(SYS_bpf, 0L, nullptr, 0L); }},
      {"userfaultfd", [] { return ::syscall(SYS_userfaultfd, 0L); }},
      {"mount", [] { return ::syscall(SYS_mount, nullptr, nullptr, nullptr, 0L, nullptr); }},
      {"move_mount", [] { return ::syscall(SYS_move_mount, 0L, nullptr, 0L, nullptr, 0L); }},
      {"unshare", [] { return ::syscall(SYS_unshare, CLONE_NEWUSER); }},
      {"setns", [] { return ::syscall(SYS_setns, 0L, 0L); }},
      {"chroot", [] { return ::syscall(SYS_chroot, "/"); }},
      {"pivot_root", [] { return ::syscall(SYS_pivot_root, nullptr, nullptr); }},
      {"add_key", [] { return ::syscall(SYS_add_key, nullptr, nullptr, nullptr, 0L, 0L); }},
      {"keyctl", [] { return ::syscall(SYS_keyctl, 0L, 0L); }},
      {"init_module", [] { return ::syscall(SYS_init_module, nullptr, 0L, nullptr); }},
      {"kexec_load", [] { return ::syscall(SYS_kexec_load, 0L, 0L, nullptr, 0L); }},
      {"reboot", [] { return ::syscall(SYS_reboot, 0L, 0L, 0L, nullptr); }},
      {"clock_settime", [] { return ::syscall(SYS_clock_settime, 0L, nullptr); }},
      {"setrlimit", [] { return ::syscall(SYS_setrlimit, RLIMIT_MEMLOCK, nullptr); }},
      {"mlockall", [] { return ::syscall(SYS_mlockall, MCL_CURRENT); }},
      {"prctl", [] { return ::syscall(SYS_prctl, PR_SET_DUMPABLE, 1L, 0L, 0L, 0L); }},
      {"seccomp", [] { return ::syscall(SYS_seccomp, 0L, 0L, nullptr); }},
      {"setresuid", [] { return ::syscall(SYS_setresuid, 0L, 0L, 0L); }},
      {"capset", [] { return ::syscall(SYS_capset, nullptr, nullptr); }},
      {"shmget", [] { return ::syscall(SYS_shmget, 0L, 4096L, 01600L); }},
      {"mq_open", [] { return ::syscall(SYS_mq_open, "/x", 0L, 0L, nullptr); }},
      {"fanotify_init", [] { return ::syscall(SYS_fanotify_init, 0L, 0L); }},
  };
}

/// A process that has entered and waits, as others see it.
struct Seen {
  int policy;
  std::string limits;
  std::string status;
};

inline Seen seenInSandbox(const Enter& enter) {
  int ready[2];
  EXPECT_EQ(::pipe2(ready, O_CLOEXEC), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ready[0]);
    (void)!::write(ready[1], enter() ? "y" : "n", 1);
    for (;;) (void)::poll(nullptr, 0, -1);
  }
  char entered = 'n';
  EXPECT_EQ(::read(ready[0], &entered, 1), 1);
  EXPECT_EQ(entered, 'y');
  const auto folder = "/proc/" + std::to_string(child);
  Seen seen{.policy = ::sched_getscheduler(child),
            .limits = readWholeFile(folder + "/limits").value_or(""),
            .status = readWholeFile(folder + "/status").value_or("")};
  ::kill(child, SIGKILL);
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
  ::close(ready[0]);
  ::close(ready[1]);
  return seen;
}

}  // namespace rc10::test::escapes
