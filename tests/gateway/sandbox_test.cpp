#include "gateway/sandbox.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/netlink.h>
#include <net/if.h>
#include <netinet/in.h>
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
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/sanitizers.hpp"
#include "app/unique_fd.hpp"
#include "app/whole_file.hpp"

namespace rc10::gateway::test::sandbox_test {
namespace {

// A child that has entered the sandbox runs this: there is no way back out of it. Its status.
int statusInSandbox(const std::function<bool()>& check) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto entered = enterSandbox(0);
    if (!entered) std::fprintf(stderr, "%s\n", entered.error().message.c_str());
    ::_exit(entered && check() ? 0 : 1);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

void inSandbox(const std::function<bool()>& check) {
  const int status = statusInSandbox(check);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "status " << status;
}

int socketError(long family, long type, long protocol = 0) {
  errno = 0;
  const UniqueFd socket{static_cast<int>(::syscall(SYS_socket, family, type, protocol))};
  return socket ? 0 : errno;
}

struct Escape {
  const char* name;
  std::function<long()> attempt;
};

// One after the other, from inside; each that is not refused is named.
[[maybe_unused]] void expectRefused(const std::vector<Escape>& escapes) {
  inSandbox([&] {
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

bool everyUserIsMapped() {
  return readWholeFile("/proc/self/uid_map").value_or("").find("4294967295") != std::string::npos;
}

TEST(Sandbox, HasTheSocketsOfLcm) {
  inSandbox([] {
    return socketError(AF_INET, SOCK_DGRAM) == 0 && socketError(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC) == 0 &&
           socketError(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE) == 0;
  });
}

TEST(Sandbox, HasNoOtherSockets) {
  inSandbox([] {
    bool none = true;
    for (long family = 0; family < AF_MAX + 2; ++family) {
      for (const long type : {SOCK_STREAM, SOCK_DGRAM, SOCK_RAW, SOCK_SEQPACKET, SOCK_PACKET}) {
        const bool lcm =
            (family == AF_INET && type == SOCK_DGRAM) || (family == AF_NETLINK && type == SOCK_RAW);
        none = none && (lcm || socketError(family, type) == EACCES);
      }
    }
    for (long protocol = 1; protocol < MAX_LINKS; ++protocol)
      none = none && socketError(AF_NETLINK, SOCK_RAW, protocol) == EACCES;
    return none;
  });
}

// The kernel looks at the lower 32 bits of these arguments.
TEST(Sandbox, UpperHalvesOfArgumentsOpenNothing) {
  inSandbox([] {
    constexpr long kUpper = 1L << 32U;
    return socketError(kUpper | AF_CAN, SOCK_RAW, CAN_RAW) == EACCES &&
           socketError(AF_CAN, kUpper | SOCK_RAW, CAN_RAW) == EACCES &&
           socketError(AF_INET, SOCK_RAW, kUpper | IPPROTO_ICMP) == EACCES &&
           socketError(kUpper | AF_INET, SOCK_STREAM) == EACCES &&
           ::syscall(SYS_tgkill, kUpper | ::getppid(), ::getppid(), 0L) == -1 && errno == EACCES &&
           ::syscall(SYS_ioctl, 0L, kUpper | TIOCSTI, "x") == -1 && errno == EACCES;
  });
}

#if !RC10_SANITIZED  // They trace their own process, start threads, and read files and more memory.
TEST(Sandbox, ReachesNoOtherProcess) {
  const pid_t rc10d = ::getpid();
  int value = 0;
  const iovec here{.iov_base = &value, .iov_len = sizeof value};
  expectRefused({
      {"kill", [&] { return ::syscall(SYS_kill, rc10d, 0L); }},
      {"tgkill", [&] { return ::syscall(SYS_tgkill, rc10d, rc10d, 0L); }},
      {"tkill", [&] { return ::syscall(SYS_tkill, rc10d, 0L); }},
      {"rt_sigqueueinfo", [&] { return ::syscall(SYS_rt_sigqueueinfo, rc10d, SIGTERM, nullptr); }},
      {"rt_tgsigqueueinfo", [&] { return ::syscall(SYS_rt_tgsigqueueinfo, rc10d, rc10d, SIGTERM, nullptr); }},
      {"pidfd_open", [&] { return ::syscall(SYS_pidfd_open, rc10d, 0L); }},
      {"pidfd_send_signal", [] { return ::syscall(SYS_pidfd_send_signal, 0L, 0L, nullptr, 0L); }},
      {"pidfd_getfd", [] { return ::syscall(SYS_pidfd_getfd, 0L, 0L, 0L); }},
      {"ptrace", [&] { return ::syscall(SYS_ptrace, PTRACE_SEIZE, rc10d, 0L, 0L); }},
      {"process_vm_readv", [&] { return ::syscall(SYS_process_vm_readv, rc10d, &here, 1L, &here, 1L, 0L); }},
      {"process_vm_writev",
       [&] { return ::syscall(SYS_process_vm_writev, rc10d, &here, 1L, &here, 1L, 0L); }},
      {"process_madvise", [] { return ::syscall(SYS_process_madvise, 0L, nullptr, 0L, 0L, 0L); }},
      {"kcmp", [&] { return ::syscall(SYS_kcmp, rc10d, rc10d, 0L, 0L, 0L); }},
      {"prlimit64", [&] { return ::syscall(SYS_prlimit64, rc10d, RLIMIT_RTPRIO, nullptr, nullptr); }},
      {"setpriority", [&] { return ::syscall(SYS_setpriority, PRIO_PROCESS, rc10d, 19L); }},
      {"sched_setscheduler", [&] { return ::syscall(SYS_sched_setscheduler, rc10d, 0L, nullptr); }},
      {"sched_setparam", [&] { return ::syscall(SYS_sched_setparam, rc10d, nullptr); }},
      {"sched_setattr", [&] { return ::syscall(SYS_sched_setattr, rc10d, nullptr, 0L); }},
      {"sched_setaffinity", [&] { return ::syscall(SYS_sched_setaffinity, rc10d, 0L, nullptr); }},
      {"ioprio_set", [&] { return ::syscall(SYS_ioprio_set, 1L, rc10d, 0L); }},
      {"migrate_pages", [&] { return ::syscall(SYS_migrate_pages, rc10d, 0L, nullptr, nullptr); }},
      {"perf_event_open", [&] { return ::syscall(SYS_perf_event_open, nullptr, rc10d, -1L, -1L, 0L); }},
  });
}

TEST(Sandbox, OpensAndChangesNoFile) {
  const std::string memory = "/proc/" + std::to_string(::getpid()) + "/mem";
  expectRefused({
      {"openat", [] { return ::syscall(SYS_openat, AT_FDCWD, "/dev/null", O_RDONLY); }},
      {"openat to write", [&] { return ::syscall(SYS_openat, AT_FDCWD, memory.c_str(), O_RDWR); }},
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
      {"connect", [] { return ::syscall(SYS_connect, 0L, nullptr, 0L); }},
      {"accept4", [] { return ::syscall(SYS_accept4, 0L, nullptr, nullptr, 0L); }},
      {"tty", [] { return ::syscall(SYS_ioctl, 0L, TIOCSTI, "x"); }},
  });
}

TEST(Sandbox, StartsNothingAndRunsNoOtherCode) {
  char name[] = "/bin/true";
  char* argv[] = {name, nullptr};
  expectRefused({
      {"execve", [&] { return ::syscall(SYS_execve, name, argv, nullptr); }},
      {"execveat", [&] { return ::syscall(SYS_execveat, AT_FDCWD, name, argv, nullptr, 0L); }},
      {"clone", [] { return ::syscall(SYS_clone, SIGCHLD, 0L, 0L, 0L, 0L); }},
      {"clone3", [] { return ::syscall(SYS_clone3, nullptr, 0L); }},
#ifdef SYS_fork  // not on arm64
      {"fork", [] { return ::syscall(SYS_fork); }},
      {"open", [] { return ::syscall(SYS_open, "/dev/null", O_RDONLY); }},
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
  });
}

TEST(Sandbox, HasNothingOfTheKernelThatLcmDoesNotTake) {
  expectRefused({
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
      {"getsockopt", [] { return ::syscall(SYS_getsockopt, 0L, SOL_SOCKET, SO_PEERCRED, nullptr, nullptr); }},
  });
}

#ifdef __x86_64__
// Calls of 32 bits, where the numbers mean other calls: 1 is exit().
TEST(Sandbox, HasNoSystemCallsOfAnotherArchitecture) {
  const int status = statusInSandbox([] {
    asm volatile("int $0x80" ::"a"(1), "b"(0) : "memory");
    return true;
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) << status;
}
#endif

TEST(Sandbox, BoundsItsMemory) {
  inSandbox([] {
    void* memory =
        ::mmap(nullptr, std::size_t{300} << 20U, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED;
  });
}
#endif

TEST(Sandbox, LimitsNamesAndMemoryStillServe) {
  inSandbox([] {
    std::vector<std::string> texts;
    for (int i = 0; i < 1000; ++i) texts.emplace_back(static_cast<std::size_t>(i) * 100, 'x');
    const UniqueFd any{::socket(AF_INET, SOCK_DGRAM, 0)};
    ifreq request{};
    request.ifr_ifindex = 1;
    return std::fprintf(stderr, "a word\n") > 0 && ::ioctl(any.get(), SIOCGIFNAME, &request) == 0 &&
           std::string(request.ifr_name) == "lo";
  });
}

TEST(Sandbox, AbortsAsOtherProgramsDo) {
  const int status = statusInSandbox([]() -> bool { std::abort(); });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
}

// Looked at from outside: in the sandbox nobody can ask.
TEST(Sandbox, HasNoRealTimeNoCapabilitiesAndNoWayBack) {
  int ready[2];
  ASSERT_EQ(::pipe2(ready, O_CLOEXEC), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ready[0]);
    (void)!::write(ready[1], enterSandbox(0) ? "y" : "n", 1);
    for (;;) (void)::poll(nullptr, 0, -1);
  }
  char entered = 'n';
  ASSERT_EQ(::read(ready[0], &entered, 1), 1);
  EXPECT_EQ(entered, 'y');
  EXPECT_EQ(::sched_getscheduler(child), SCHED_OTHER);
  const auto limits = readWholeFile("/proc/" + std::to_string(child) + "/limits").value_or("");
  for (const char* line : {"Max realtime priority     0                    0",
                           "Max nice priority         0                    0",
                           "Max open files            32                   32"})
    EXPECT_NE(limits.find(line), std::string::npos) << line << " in\n" << limits;
  const auto status = readWholeFile("/proc/" + std::to_string(child) + "/status").value_or("");
  for (const char* line : {"CapEff:\t0000000000000000", "CapPrm:\t0000000000000000",
                           "CapAmb:\t0000000000000000", "NoNewPrivs:\t1", "Seccomp:\t2"})
    EXPECT_NE(status.find(line), std::string::npos) << line << " in\n" << status;
  // Root of a user namespace without other users stays what it is: an ordinary user of the computer.
  if (::geteuid() == 0 && everyUserIsMapped()) {
    EXPECT_EQ(status.find("Uid:\t0\t"), std::string::npos) << status;
    EXPECT_EQ(status.find("Gid:\t0\t"), std::string::npos) << status;
  }
  ::kill(child, SIGKILL);
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
  ::close(ready[0]);
  ::close(ready[1]);
}

}  // namespace
}  // namespace rc10::gateway::test::sandbox_test
