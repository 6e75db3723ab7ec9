#include "web/sandbox.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/capability.h>
#include <linux/landlock.h>
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
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>

#include <gtest/gtest.h>

#include "app/sanitizers.hpp"
#include "app/unique_fd.hpp"
#include "app/whole_file.hpp"
#include "support/escapes.hpp"
#include "web/bounded_child.hpp"

namespace rc10::web::test::sandbox_test {
namespace {

using namespace rc10::test::escapes;
namespace fs = std::filesystem;

class WebSandbox : public testing::Test {
 protected:
  WebSandbox() {
    fs::create_directories(run_);
    std::ofstream(run_ / "robot.log") << "a line";
    std::ofstream(beside_) << "secret";
  }
  ~WebSandbox() override { fs::remove_all(parent_); }

  Enter enter = [this] { return enterSandbox({run_.string(), "/var/lib/rc10d"}); };
  // Two levels below one of its own: what lies beside the folder may be read, all else not.
  const fs::path parent_ = fs::path{testing::TempDir()} / ("rc10-web-sandbox-" + std::to_string(::getpid()));
  const fs::path run_ = parent_ / "beside" / "run";
  const fs::path beside_ = parent_ / "secret";
};

TEST_F(WebSandbox, HasTheSocketsOfRc10dAlone) {
  inSandbox(enter, [] {
    const auto has = [](long family, long type) {
      return family == AF_UNIX && (type == SOCK_SEQPACKET || type == SOCK_DGRAM);
    };
    return socketError(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC) == 0 &&
           socketError(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC) == 0 && hasNoOtherSockets(has);
  });
}

// The kernel looks at the lower 32 bits of these arguments.
TEST_F(WebSandbox, UpperHalvesOfArgumentsOpenNothing) {
  inSandbox(enter, [] {
    constexpr long kUpper = 1L << 32U;
    const auto opens = [] { return ::syscall(SYS_openat, AT_FDCWD, "/dev/null", kUpper | O_RDWR) != -1; };
    return socketError(kUpper | AF_CAN, SOCK_RAW, CAN_RAW) == EACCES &&
           socketError(AF_UNIX, kUpper | SOCK_STREAM) == EACCES &&
           // Sanitizers read files.
           (kSanitized || (!opens() && errno == EACCES)) &&
           ::syscall(SYS_fcntl, 0L, kUpper | F_SETOWN, ::getppid()) == -1 && errno == EACCES;
  });
}

TEST_F(WebSandbox, ListsAndReadsItsFolders) {
  inSandbox(enter, [&] {
    std::error_code error;
    const bool listed = fs::directory_iterator(run_, error) != fs::directory_iterator{} && !error;
    return listed && readWholeFile((run_ / "robot.log").string()) == "a line";
  });
}

// rc10d, which starts after rc10-web, makes its folder.
TEST_F(WebSandbox, ReadsAFolderThatComesLater) {
  const auto later = run_.parent_path() / "later";
  int entered[2];
  int made[2];
  ASSERT_EQ(::pipe2(entered, O_CLOEXEC), 0);
  ASSERT_EQ(::pipe2(made, O_CLOEXEC), 0);
  const std::jthread rc10d{[&] {
    char any = 0;
    (void)!::read(entered[0], &any, 1);
    fs::create_directory(later);
    std::ofstream(later / "robot.log") << "a line";
    (void)!::write(made[1], "x", 1);
  }};
  inSandbox([&] { return enterSandbox({later.string()}); },
            [&] {
              char any = 0;
              return ::write(entered[1], "x", 1) == 1 && ::read(made[0], &any, 1) == 1 &&
                     readWholeFile((later / "robot.log").string()) == "a line";
            });
}

#if !RC10_SANITIZED  // They trace their own process, start threads, and read files and more memory.
bool hasLandlock() {
  return ::syscall(SYS_landlock_create_ruleset, nullptr, 0L, LANDLOCK_CREATE_RULESET_VERSION) > 0;
}

TEST_F(WebSandbox, ReachesNoOtherProcess) { expectRefused(enter, toOtherProcesses(::getpid())); }

TEST_F(WebSandbox, WritesAndChangesNoFile) {
  const auto own = (run_ / "robot.log").string();
  expectRefused(enter, byFiles(::getpid()));
  expectRefused(
      enter,
      {
          {"write", [&] { return ::syscall(SYS_openat, AT_FDCWD, own.c_str(), O_WRONLY); }},
          {"append", [&] { return ::syscall(SYS_openat, AT_FDCWD, own.c_str(), O_RDONLY | O_APPEND); }},
          {"truncate", [&] { return ::syscall(SYS_openat, AT_FDCWD, own.c_str(), O_RDONLY | O_TRUNC); }},
          {"make", [&] { return ::syscall(SYS_openat, AT_FDCWD, "x", O_RDONLY | O_CREAT, 0600); }},
          {"nameless", [&] { return ::syscall(SYS_openat, AT_FDCWD, "/tmp", O_TMPFILE | O_RDWR, 0600); }},
          {"signals to others", [] { return ::syscall(SYS_fcntl, 0L, F_SETOWN, ::getppid()); }},
          {"lease", [] { return ::syscall(SYS_fcntl, 0L, F_SETLEASE, F_WRLCK); }},
          {"bind", [] { return ::syscall(SYS_bind, 0L, nullptr, 0L); }},
          {"listen", [] { return ::syscall(SYS_listen, 0L, 1L); }},
      });
}

TEST_F(WebSandbox, ReadsNoOtherFileWhereTheKernelHasLandlock) {
  const auto reads = [](const std::string& path) {
    return [path] { return ::syscall(SYS_openat, AT_FDCWD, path.c_str(), O_RDONLY | O_CLOEXEC); };
  };
  const Escapes readings{{"a file beside the folder beside", reads(beside_.string())},
                         {"a device", reads("/dev/null")},
                         {"users", reads("/etc/passwd")},
                         {"a program", reads("/proc/self/exe")}};
  if (hasLandlock()) return expectRefused(enter, readings);
  inSandbox(enter, [&] { return readings[0].attempt() >= 0; });
}

TEST_F(WebSandbox, StartsNothingAndRunsNoOtherCode) { expectRefused(enter, byPrograms()); }

TEST_F(WebSandbox, HasNothingOfTheKernelThatAServerDoesNotTake) { expectRefused(enter, byTheKernel()); }

TEST_F(WebSandbox, BoundsItsMemory) {
  inSandbox(enter, [] {
    void* memory =
        ::mmap(nullptr, std::size_t{200} << 20U, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED;
  });
}
#endif

TEST_F(WebSandbox, WorksInAProcessOfItsOwnThatIsBounded) {
  inSandbox(enter, [] {
    const MonotonicTime now{};
    auto child = BoundedChild::start([] { return std::string{"an answer"}; }, now);
    for (int i = 0; child && i < 10'000; ++i) {
      if (const auto answer = child->poll(now)) return *answer && **answer == "an answer";
      (void)::poll(nullptr, 0, 1);
    }
    return false;
  });
}

TEST_F(WebSandbox, AbortsAsOtherProgramsDo) {
  const int status = statusInSandbox(enter, []() -> bool { std::abort(); });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
}

// Looked at from outside: in the sandbox nobody can ask.
TEST_F(WebSandbox, HasNoRealTimeNoMoreThanOneCapabilityAndNoWayBack) {
  const auto seen = seenInSandbox(enter);
  EXPECT_EQ(seen.policy, SCHED_OTHER);
  for (const char* line : {"Max realtime priority     0                    0",
                           "Max nice priority         0                    0"})
    EXPECT_NE(seen.limits.find(line), std::string::npos) << line << " in\n" << seen.limits;
  for (const char* line :
       {"CapInh:\t0000000000000000", "CapAmb:\t0000000000000000", "NoNewPrivs:\t1", "Seccomp:\t2"})
    EXPECT_NE(seen.status.find(line), std::string::npos) << line << " in\n" << seen.status;
  const auto at = seen.status.find("CapPrm:\t");
  ASSERT_NE(at, std::string::npos);
  const auto permitted = std::stoull(seen.status.substr(at + 8, 16), nullptr, 16);
  EXPECT_EQ(permitted & ~(1ULL << unsigned{CAP_DAC_OVERRIDE}), 0U) << seen.status;
}

}  // namespace
}  // namespace rc10::web::test::sandbox_test
