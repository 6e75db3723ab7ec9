#include "daemon/signal_inbox.hpp"

#include <pthread.h>
#include <signal.h>

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
namespace {

using ::testing::HasSubstr;

// signal(7): these cannot be taken, are faults of the process itself, or do nothing by default.
const std::set<int> kNotTaken{SIGKILL, SIGSTOP, SIGSEGV, SIGBUS, SIGFPE,   SIGILL, SIGTRAP,
                              SIGABRT, SIGSYS,  SIGCONT, SIGURG, SIGWINCH, SIGPIPE};

class SignalInboxTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::pthread_sigmask(SIG_SETMASK, nullptr, &mask_), 0); }
  void TearDown() override {
    ::signal(SIGHUP, hangup_);
    ::signal(SIGPIPE, pipe_);
    ::pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
  }

 private:
  sigset_t mask_{};
  sighandler_t pipe_ = ::signal(SIGPIPE, SIG_IGN);
  sighandler_t hangup_ = ::signal(SIGHUP, SIG_DFL);  ///< Ignored under nohup.
};

TEST_F(SignalInboxTest, ReadsEverySignalThatWouldEndOrStopTheProcess) {
  SignalInbox inbox;
  for (int number = 1; number <= SIGRTMAX; ++number) {
    // Two between the classic and the real-time signals are glibc's own.
    if (kNotTaken.contains(number) || (number > SIGSYS && number < SIGRTMIN)) continue;
    ASSERT_EQ(::pthread_kill(::pthread_self(), number), 0) << number;
    EXPECT_EQ(inbox.take(), number);
  }
  EXPECT_EQ(inbox.take(), 0);
}

TEST_F(SignalInboxTest, ASighupThatWasIgnoredFromTheStartStaysIgnored) {
  ::signal(SIGHUP, SIG_IGN);
  SignalInbox inbox;
  ASSERT_EQ(::pthread_kill(::pthread_self(), SIGHUP), 0);
  EXPECT_EQ(inbox.take(), 0);
}

TEST(SignalMeaning, ALogLineEndsNoMatchAndEverythingElseStops) {
  for (const int number : {SIGXFSZ, SIGTTIN, SIGTTOU})
    EXPECT_EQ(meaningOf(number), SignalMeaning::kIgnored) << number;
  for (const int number :
       {SIGTERM, SIGINT, SIGQUIT, SIGTSTP, SIGHUP, SIGUSR1, SIGALRM, SIGXCPU, SIGRTMIN + 3})
    EXPECT_EQ(meaningOf(number), SignalMeaning::kStop) << number;
  EXPECT_EQ(meaningOf(SIGCHLD), SignalMeaning::kChild);
}

TEST(SignalMeaning, IsToldWithTheNameAndTheReason) {
  EXPECT_EQ(describeSignal(SIGTERM), "SIGTERM");
  EXPECT_THAT(describeSignal(SIGHUP), HasSubstr("SIGHUP (the terminal was closed"));
  EXPECT_THAT(describeSignal(SIGXFSZ), HasSubstr("ulimit -f"));
  EXPECT_EQ(describeSignal(SIGRTMIN + 1), "signal " + std::to_string(SIGRTMIN + 1));
}

}  // namespace
}  // namespace rc10
