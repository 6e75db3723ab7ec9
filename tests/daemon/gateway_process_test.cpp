#include "daemon/gateway_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "app/unique_fd.hpp"

namespace rc10::test::gateway_process_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

std::vector<std::string> script(const std::string& text) { return {"-c", text}; }

/// Waits until the child has ended, and leaves it to be noticed.
void awaitEnd(const GatewayProcess& gateway) {
  siginfo_t info{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(gateway.pid()), &info, WEXITED | WNOWAIT), 0);
}

/// A pipe that children inherit, as /dev/fd/N.
struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) ADD_FAILURE() << "pipe";
    read_end = UniqueFd{ends[0]};
    write_end = UniqueFd{ends[1]};
  }
  [[nodiscard]] std::string path() const { return "/dev/fd/" + std::to_string(write_end.get()); }
  /// The next line a child writes; waits for it.
  [[nodiscard]] std::string line() const {
    std::string out;
    for (char c = 0; ::read(read_end.get(), &c, 1) == 1 && c != '\n';) out += c;
    return out;
  }

  UniqueFd read_end;
  UniqueFd write_end;
};

class GatewayProcessTest : public ::testing::Test {
 protected:
  /// Starts, waits for the end, notices it.
  std::string startAndNotice(GatewayProcess& gateway) {
    EXPECT_EQ(gateway.supervise(now), "");
    EXPECT_NE(gateway.pid(), 0);
    awaitEnd(gateway);
    auto message = gateway.supervise(now);
    EXPECT_EQ(gateway.pid(), 0);
    return message;
  }

  MonotonicTime now{1000s};
};

TEST_F(GatewayProcessTest, StartsItsProgramWithItsArguments) {
  GatewayProcess gateway("/bin/sh", {"-c", "test \"$1 $2\" = 'a b' && exit 7", "sh", "a", "b"});
  EXPECT_THAT(startAndNotice(gateway), HasSubstr("exit status 7"));
}

TEST_F(GatewayProcessTest, LeavesARunningOneAlone) {
  GatewayProcess gateway("/bin/sh", script("exec sleep 1000"));
  EXPECT_EQ(gateway.supervise(now), "");
  const auto pid = gateway.pid();
  EXPECT_EQ(gateway.supervise(now + 1h), "");
  EXPECT_EQ(gateway.pid(), pid);
}

TEST_F(GatewayProcessTest, StartsItAgainWithABackOffThatDoublesUpToFiveSeconds) {
  GatewayProcess gateway("/bin/sh", script("exit 3"));
  for (const int wait_ms : {100, 200, 400, 800, 1600, 3200, 5000, 5000}) {
    EXPECT_THAT(startAndNotice(gateway), HasSubstr("exit status 3)"));
    EXPECT_EQ(gateway.supervise(now + std::chrono::milliseconds{wait_ms} - 1ns), "");
    EXPECT_EQ(gateway.pid(), 0) << "before " << wait_ms << " ms";
    now += std::chrono::milliseconds{wait_ms};
  }
}

TEST_F(GatewayProcessTest, SaysWhenItStartsItAgain) {
  GatewayProcess gateway("/bin/sh", script("exit 3"));
  EXPECT_THAT(startAndNotice(gateway), HasSubstr("again in 100 ms"));
  now += 100ms;
  EXPECT_THAT(startAndNotice(gateway), HasSubstr("again in 200 ms"));
}

TEST_F(GatewayProcessTest, OneThatRanForTenSecondsIsStartedQuicklyAgain) {
  GatewayProcess gateway("/bin/sh", script("exit 3"));
  for (int i = 0; i < 4; ++i) {
    (void)startAndNotice(gateway);
    now += 5s;
  }
  ASSERT_EQ(gateway.supervise(now), "");
  awaitEnd(gateway);
  now += 10s;
  EXPECT_THAT(gateway.supervise(now), HasSubstr("again in 100 ms"));
}

TEST_F(GatewayProcessTest, SaysWhichSignalKilledIt) {
  GatewayProcess gateway("/bin/sh", script("kill -KILL $$"));
  EXPECT_THAT(startAndNotice(gateway), HasSubstr("killed by signal 9"));
}

TEST_F(GatewayProcessTest, SaysThatItWasStoppedAndThatItGoesOn) {
  GatewayProcess gateway("/bin/sh", script("exec sleep 1000"));
  ASSERT_EQ(gateway.supervise(now), "");
  const auto change = [&gateway](int signal, int how) {
    siginfo_t info{};
    EXPECT_EQ(::kill(gateway.pid(), signal), 0);
    EXPECT_EQ(::waitid(P_PID, static_cast<id_t>(gateway.pid()), &info, how | WNOWAIT), 0);
  };
  change(SIGSTOP, WSTOPPED);
  EXPECT_THAT(gateway.supervise(now), HasSubstr("kill -CONT " + std::to_string(gateway.pid())));
  EXPECT_EQ(gateway.supervise(now), "") << "once";
  change(SIGCONT, WCONTINUED);
  EXPECT_EQ(gateway.supervise(now), "rc10-lcm goes on");
}

TEST_F(GatewayProcessTest, AMissingProgramIsNamedAndTriedAgainLater) {
  GatewayProcess gateway("/no/such/rc10-lcm", {});
  const auto message = gateway.supervise(now);
  EXPECT_THAT(message, HasSubstr("/no/such/rc10-lcm could not be started: No such file"));
  EXPECT_EQ(gateway.pid(), 0);
  EXPECT_EQ(gateway.supervise(now + 5s - 1ns), "");
  EXPECT_EQ(gateway.supervise(now + 5s), message);
}

TEST_F(GatewayProcessTest, TheChildTakesSignalsAsAFreshProcessDoes) {
  // As in rc10d: blocked for signalfd, and SIGPIPE ignored.
  sigset_t blocked;
  sigset_t before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  ASSERT_EQ(::pthread_sigmask(SIG_BLOCK, &blocked, &before), 0);
  const auto pipe_before = ::signal(SIGPIPE, SIG_IGN);
  GatewayProcess term("/bin/sh", script("kill -TERM $$; exit 0"));
  EXPECT_THAT(startAndNotice(term), HasSubstr("killed by signal 15"));
  GatewayProcess pipe("/bin/sh", script("kill -PIPE $$; exit 0"));
  EXPECT_THAT(startAndNotice(pipe), HasSubstr("killed by signal 13"));
  ::signal(SIGPIPE, pipe_before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST_F(GatewayProcessTest, StopLetsItFinish) {
  const Pipe pipe;
  // No child of its own that could outlive it: it turns until the signal comes.
  GatewayProcess gateway(
      "/bin/sh", script("trap 'echo bye > " + pipe.path() + "; exit 0' TERM; echo ready > " + pipe.path() +
                        "; while :; do :; done"));
  ASSERT_EQ(gateway.supervise(now), "");
  ASSERT_EQ(pipe.line(), "ready");
  gateway.stop();
  EXPECT_EQ(gateway.pid(), 0);
  EXPECT_EQ(pipe.line(), "bye");
}

TEST_F(GatewayProcessTest, StopKillsOneThatIgnoresSigterm) {
  const Pipe pipe;
  GatewayProcess gateway("/bin/sh",
                         script("trap '' TERM; echo ready > " + pipe.path() + "; exec sleep 1000"));
  ASSERT_EQ(gateway.supervise(now), "");
  ASSERT_EQ(pipe.line(), "ready");
  const auto pid = gateway.pid();
  gateway.stop();
  EXPECT_EQ(gateway.pid(), 0);
  EXPECT_EQ(::kill(pid, 0), -1);
  EXPECT_EQ(errno, ESRCH) << "it is gone, and no zombie";
}

TEST_F(GatewayProcessTest, StopIsHarmlessBeforeTheStartAndASecondTime) {
  GatewayProcess gateway("/bin/sh", script("exec sleep 1000"));
  gateway.stop();
  ASSERT_EQ(gateway.supervise(now), "");
  gateway.stop();
  gateway.stop();
  EXPECT_EQ(gateway.pid(), 0);
}

TEST_F(GatewayProcessTest, StopTakesOneThatHasEndedAlready) {
  GatewayProcess gateway("/bin/sh", script("exit 0"));
  ASSERT_EQ(gateway.supervise(now), "");
  awaitEnd(gateway);
  gateway.stop();
  EXPECT_EQ(gateway.pid(), 0);
}

TEST_F(GatewayProcessTest, DoesNotOutliveItsOwner) {
  pid_t pid = 0;
  {
    GatewayProcess gateway("/bin/sh", script("exec sleep 1000"));
    ASSERT_EQ(gateway.supervise(now), "");
    pid = gateway.pid();
  }
  EXPECT_EQ(::kill(pid, 0), -1);
}

}  // namespace
}  // namespace rc10::test::gateway_process_test
