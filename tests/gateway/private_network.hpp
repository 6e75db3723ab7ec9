#pragma once

#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include <gtest/gtest.h>

namespace rc10::private_network {

inline bool writeFile(const char* path, const std::string& text) {
  const int fd = ::open(path, O_WRONLY | O_CLOEXEC);
  const bool done = fd >= 0 && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (fd >= 0) ::close(fd);
  return done;
}

/// A network of this process alone, with a loopback that is up. No multicast leaves the test.
inline bool enterPrivateNetwork() {
  // Root needs no user namespace, which a process with threads, as ThreadSanitizer's is, may not enter.
  if (::unshare(CLONE_NEWNET) == 0) return std::system("ip link set lo up") == 0;
  const auto uid = ::getuid();
  const auto gid = ::getgid();
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  (void)writeFile("/proc/self/setgroups", "deny");
  return writeFile("/proc/self/uid_map", "0 " + std::to_string(uid) + " 1") &&
         writeFile("/proc/self/gid_map", "0 " + std::to_string(gid) + " 1") &&
         std::system("ip link set lo up") == 0;
}

inline bool addLcmRoute() { return std::system("ip route add 239.255.76.67/32 dev lo src 127.0.0.1") == 0; }

/// Runs `body` in a child process in its own network; its failures are the test's. Skips where the system
/// does not allow it.
inline void inPrivateNetwork(const std::function<void()>& body) {
  constexpr int kNotAllowed = 77;
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    if (!enterPrivateNetwork()) ::_exit(kNotAllowed);
    body();
    std::fflush(stdout);
    ::_exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotAllowed) {
    GTEST_SKIP() << "no network namespaces here: user namespaces are not allowed, or `ip` is missing";
  }
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "status " << status << ", see above";
}

}  // namespace rc10::private_network

namespace rc10::test {
using private_network::addLcmRoute;
using private_network::enterPrivateNetwork;
using private_network::inPrivateNetwork;
}  // namespace rc10::test
