#include "gateway/sandbox.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/netlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/sanitizers.hpp"
#include "app/unique_fd.hpp"
#include "app/whole_file.hpp"
#include "support/escapes.hpp"

namespace rc10::gateway::test::sandbox_test {
namespace {

using namespace rc10::test::escapes;

Result<void> enter() { return enterSandbox(0); }

bool everyUserIsMapped() {
  return readWholeFile("/proc/self/uid_map").value_or("").find("4294967295") != std::string::npos;
}

TEST(Sandbox, HasTheSocketsOfLcm) {
  inSandbox(enter, [] {
    return socketError(AF_INET, SOCK_DGRAM) == 0 && socketError(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC) == 0 &&
           socketError(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE) == 0;
  });
}

TEST(Sandbox, HasNoOtherSockets) {
  inSandbox(enter, [] {
    bool none = hasNoOtherSockets([](long family, long type) {
      return (family == AF_INET && type == SOCK_DGRAM) || (family == AF_NETLINK && type == SOCK_RAW);
    });
    for (long protocol = 1; protocol < MAX_LINKS; ++protocol)
      none = none && socketError(AF_NETLINK, SOCK_RAW, protocol) == EACCES;
    return none;
  });
}

// The kernel looks at the lower 32 bits of these arguments.
TEST(Sandbox, UpperHalvesOfArgumentsOpenNothing) {
  inSandbox(enter, [] {
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
TEST(Sandbox, ReachesNoOtherProcess) { expectRefused(enter, toOtherProcesses(::getpid())); }

TEST(Sandbox, OpensAndChangesNoFile) {
  expectRefused(enter, byFiles(::getpid()));
  expectRefused(enter, {
                           {"openat", [] { return ::syscall(SYS_openat, AT_FDCWD, "/dev/null", O_RDONLY); }},
                           {"connect", [] { return ::syscall(SYS_connect, 0L, nullptr, 0L); }},
                           {"accept4", [] { return ::syscall(SYS_accept4, 0L, nullptr, nullptr, 0L); }},
                       });
}

TEST(Sandbox, StartsNothingAndRunsNoOtherCode) {
  expectRefused(enter, byPrograms());
#ifdef SYS_open  // not on arm64
  expectRefused(enter, {{"open", [] { return ::syscall(SYS_open, "/dev/null", O_RDONLY); }}});
#endif
}

TEST(Sandbox, HasNothingOfTheKernelThatLcmDoesNotTake) {
  expectRefused(enter, byTheKernel());
  expectRefused(enter,
                {
                    {"getsockopt",
                     [] { return ::syscall(SYS_getsockopt, 0L, SOL_SOCKET, SO_PEERCRED, nullptr, nullptr); }},
                });
}

#ifdef __x86_64__
// Calls of 32 bits, where the numbers mean other calls: 1 is exit().
TEST(Sandbox, HasNoSystemCallsOfAnotherArchitecture) {
  const int status = statusInSandbox(enter, [] {
    asm volatile("int $0x80" ::"a"(1), "b"(0) : "memory");
    return true;
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) << status;
}
#endif

TEST(Sandbox, BoundsItsMemory) {
  inSandbox(enter, [] {
    void* memory =
        ::mmap(nullptr, std::size_t{300} << 20U, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED;
  });
}
#endif

TEST(Sandbox, LimitsNamesAndMemoryStillServe) {
  inSandbox(enter, [] {
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
  const int status = statusInSandbox(enter, []() -> bool { std::abort(); });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
}

// Looked at from outside: in the sandbox nobody can ask.
TEST(Sandbox, HasNoRealTimeNoCapabilitiesAndNoWayBack) {
  const auto seen = seenInSandbox(enter);
  EXPECT_EQ(seen.policy, SCHED_OTHER);
  for (const char* line : {"Max realtime priority     0                    0",
                           "Max nice priority         0                    0",
                           "Max open files            32                   32"})
    EXPECT_NE(seen.limits.find(line), std::string::npos) << line << " in\n" << seen.limits;
  for (const char* line : {"CapEff:\t0000000000000000", "CapPrm:\t0000000000000000",
                           "CapAmb:\t0000000000000000", "NoNewPrivs:\t1", "Seccomp:\t2"})
    EXPECT_NE(seen.status.find(line), std::string::npos) << line << " in\n" << seen.status;
  // Root of a user namespace without other users stays what it is: an ordinary user of the computer.
  if (::geteuid() == 0 && everyUserIsMapped()) {
    EXPECT_EQ(seen.status.find("Uid:\t0\t"), std::string::npos) << seen.status;
    EXPECT_EQ(seen.status.find("Gid:\t0\t"), std::string::npos) << seen.status;
  }
}

}  // namespace
}  // namespace rc10::gateway::test::sandbox_test
