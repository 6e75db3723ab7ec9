#include "gateway/sandbox.hpp"

#include <linux/can.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>

#include "app/sanitizers.hpp"
#include "app/unique_fd.hpp"

namespace rc10::gateway::test::sandbox_test {
namespace {

// Runs `check` in a child that has entered the sandbox: there is no way back out of it.
void inSandbox(const std::function<bool()>& check) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto entered = enterSandbox(0);
    if (!entered) std::fprintf(stderr, "%s\n", entered.error().message.c_str());
    ::_exit(entered && check() ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "status " << status;
}

int socketError(int family, int type, int protocol = 0) {
  const UniqueFd socket{::socket(family, type, protocol)};
  return socket ? 0 : errno;
}

TEST(Sandbox, HasNoCanAndNoRawSockets) {
  inSandbox([] {
    return socketError(AF_CAN, SOCK_RAW, CAN_RAW) == EACCES && socketError(AF_PACKET, SOCK_RAW) == EACCES;
  });
}

TEST(Sandbox, HasTheSocketsOfLcm) {
  inSandbox([] { return socketError(AF_INET, SOCK_DGRAM) == 0 && socketError(AF_NETLINK, SOCK_RAW) == 0; });
}

TEST(Sandbox, HasNoRealTime) {
  inSandbox([] {
    const sched_param high{.sched_priority = 1};
    rlimit limit{};
    ::getrlimit(RLIMIT_RTPRIO, &limit);
    return ::sched_setscheduler(0, SCHED_FIFO, &high) != 0 && ::sched_getscheduler(0) == SCHED_OTHER &&
           limit.rlim_max == 0;
  });
}

TEST(Sandbox, StartsNoPrograms) {
  inSandbox([] {
    char name[] = "/bin/true";
    char* argv[] = {name, nullptr};
    return ::execv(name, argv) != 0 && errno == EACCES;
  });
}

TEST(Sandbox, CannotBeLeft) {
  inSandbox([] {
    rlimit more{};
    ::getrlimit(RLIMIT_MEMLOCK, &more);
    more.rlim_max += 4096;
    more.rlim_cur = more.rlim_max;
    return ::prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1 && ::setrlimit(RLIMIT_MEMLOCK, &more) != 0;
  });
}

// Sanitizers need more memory than the sandbox has.
#if !RC10_SANITIZED
TEST(Sandbox, BoundsItsMemory) {
  inSandbox([] {
    void* memory =
        ::mmap(nullptr, std::size_t{300} << 20U, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED;
  });
}
#endif

}  // namespace
}  // namespace rc10::gateway::test::sandbox_test
