#include "link/process_identity.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace rc10::link::test::process_identity_test {
namespace {

TEST(ProcessIdentityTest, IsReadAsItWasWritten) {
  const auto own = ProcessIdentity::own();
  EXPECT_GT(own.start_ticks, 0U);
  const auto read = ProcessIdentity::in("# title\n" + own.line() + "\ncan0 200#00\n");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->pid, ::getpid());
  EXPECT_EQ(read->start_ticks, own.start_ticks);
  EXPECT_TRUE(read->runs());
}

TEST(ProcessIdentityTest, OtherTextHasNone) {
  for (const char* text : {"", "can0 200#00\n", "# pid\n", "# pid x, start 1\n", "# pid -3, start 1\n",
                           "# pid 3\n", "# pid 3, start \n", "a # pid 3, start 1\n"})
    EXPECT_FALSE(ProcessIdentity::in(text)) << text;
}

TEST(ProcessIdentityTest, AnotherProcessOfTheSameNumberIsAnother) {
  auto other = ProcessIdentity::own();
  ++other.start_ticks;
  EXPECT_FALSE(other.runs());
}

TEST(ProcessIdentityTest, OneThatEndedAndThatNobodyHasReapedRunsNoLonger) {
  const pid_t child = ::fork();
  if (child == 0)
    for (;;) ::pause();
  const ProcessIdentity identity{.pid = child, .start_ticks = 0};
  EXPECT_TRUE(identity.runs());
  ::kill(child, SIGKILL);
  siginfo_t info{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);
  EXPECT_FALSE(identity.runs());
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_FALSE(identity.runs());
}

}  // namespace
}  // namespace rc10::link::test::process_identity_test
