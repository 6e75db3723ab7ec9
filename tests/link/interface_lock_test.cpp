#include "link/interface_lock.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace rc10::link::test::interface_lock_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::StrEq;

// No interface has such an index: nobody else on this computer has its lock.
const int kFirstIndex = 1'000'000'000 + ::getpid();

class InterfaceLockTest : public testing::Test {
 protected:
  static Result<InterfaceLock> take(int index, const std::string& robot) {
    return InterfaceLock::take(index, "can0", robot);
  }
  static std::string here(const std::string& robot) {
    return "robot '" + robot + "' (rc10d, pid " + std::to_string(::getpid()) + ")";
  }
  /// Another process's view of `check`, true or not.
  template <typename Check>
  static bool elsewhere(Check check) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(check() ? 0 : 1);
    int status = 0;
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  int index = kFirstIndex;
};

TEST_F(InterfaceLockTest, ASecondRobotIsToldWhoDrivesTheInterface) {
  const auto first = take(index, "hero");
  ASSERT_TRUE(first);
  const auto second = take(index, "sentry");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, StrEq("can0 is driven by " + here("hero") + "; stop it first"));
}

TEST_F(InterfaceLockTest, AnotherNameOrAnotherRunFolderIsNoWayAroundIt) {
  const auto first = InterfaceLock::take(index, "can0", "hero");
  ASSERT_TRUE(first);
  ASSERT_EQ(::setenv("RC10_RUN_DIR", "/no/such/folder", 1), 0);
  EXPECT_FALSE(InterfaceLock::take(index, "front", "hero"));
  EXPECT_THAT(InterfaceLock::holder(index), StrEq(here("hero")));
  ::unsetenv("RC10_RUN_DIR");
}

TEST_F(InterfaceLockTest, ARefusedOneLeavesTheLockWithTheFirst) {
  const auto first = take(index, "hero");
  ASSERT_TRUE(first);
  ASSERT_FALSE(take(index, "sentry"));
  EXPECT_THAT(InterfaceLock::holder(index), StrEq(here("hero")));
}

TEST_F(InterfaceLockTest, OtherInterfacesAreFree) {
  const auto first = take(index, "hero");
  // Its number begins as that of the first.
  const auto second = take(kFirstIndex / 10, "sentry");
  EXPECT_TRUE(first && second);
  EXPECT_THAT(InterfaceLock::holder(kFirstIndex / 10), StrEq(here("sentry")));
  EXPECT_THAT(InterfaceLock::holder(kFirstIndex / 100), IsEmpty());
}

TEST_F(InterfaceLockTest, EndsWithItsOwner) {
  {
    auto lock = take(index, "a_name_that_is_longer_than_others");
    ASSERT_TRUE(lock);
    const InterfaceLock moved = std::move(*lock);
    EXPECT_THAT(InterfaceLock::holder(index), HasSubstr("longer"));
  }
  EXPECT_THAT(InterfaceLock::holder(index), IsEmpty());
  const auto next = take(index, "b");
  ASSERT_TRUE(next);
  EXPECT_THAT(InterfaceLock::holder(index), StrEq(here("b")));
}

TEST_F(InterfaceLockTest, EndsWithAProcessThatIsKilled) {
  int ready[2];
  ASSERT_EQ(::pipe2(ready, O_CLOEXEC), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = take(index, "hero");
    (void)!::write(ready[1], lock ? "y" : "n", 1);
    for (;;) ::pause();
  }
  char answer = 0;
  ASSERT_EQ(::read(ready[0], &answer, 1), 1);
  ASSERT_EQ(answer, 'y');
  EXPECT_THAT(InterfaceLock::holder(index), HasSubstr("pid " + std::to_string(child)));
  EXPECT_FALSE(take(index, "hero"));
  ::kill(child, SIGKILL);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_THAT(InterfaceLock::holder(index), IsEmpty());
  EXPECT_TRUE(take(index, "hero"));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(InterfaceLockTest, IsNotInheritedByOtherPrograms) {
  const auto lock = take(index, "hero");
  ASSERT_TRUE(lock);
  for (int file = 3; file < 256; ++file) {
    sockaddr_un name{};
    socklen_t size = sizeof name;
    if (::getsockname(file, reinterpret_cast<sockaddr*>(&name), &size) != 0) continue;
    if (name.sun_family != AF_UNIX || std::strncmp(name.sun_path + 1, "rc10d-interface", 15) != 0) continue;
    EXPECT_NE(::fcntl(file, F_GETFD) & FD_CLOEXEC, 0) << file;
  }
}

TEST_F(InterfaceLockTest, LookingTakesNothingHoweverOftenAndFillsNothing) {
  const auto lock = take(index, "hero");
  ASSERT_TRUE(lock);
  for (int look = 0; look < 1'000; ++look) ASSERT_THAT(InterfaceLock::holder(index), StartsWith("robot"));
  EXPECT_THAT(InterfaceLock::holder(index + 1), IsEmpty());
  EXPECT_TRUE(take(index + 1, "sentry"));
}

TEST_F(InterfaceLockTest, OneWithoutWordsIsToldWithTheWayToFindIt) {
  const std::string name = "rc10d-interface/" + std::to_string(index);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path + 1, name.size());
  const UniqueFd stranger{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  ASSERT_EQ(::bind(stranger.get(), reinterpret_cast<const sockaddr*>(&address),
                   static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size())),
            0);
  EXPECT_THAT(take(index, "hero").error().message,
              HasSubstr("driven by another program (`sudo ss -xap | grep " + name + "` names it)"));
}

TEST_F(InterfaceLockTest, WordsOfAStrangerActOnNoTerminal) {
  const auto lock = take(index, "\x1b[2Jhero\nmore");
  ASSERT_TRUE(lock);
  EXPECT_THAT(InterfaceLock::holder(index), StartsWith("robot '?[2Jhero"));
}

TEST_F(InterfaceLockTest, AnInterfaceOfAnotherNetworkNamespaceIsAnotherOne) {
  const auto lock = take(index, "hero");
  ASSERT_TRUE(lock);
  EXPECT_TRUE(elsewhere([&] {
    const bool alone = ::unshare(CLONE_NEWNET) == 0 || ::unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0;
    return alone && InterfaceLock::holder(index).empty() && take(index, "hero").has_value();
  }));
}

TEST_F(InterfaceLockTest, WhereThereIsNoInterfaceNobodyDrivesIt) {
  EXPECT_THAT(holderOfInterface("rc10nosuch"), IsEmpty());
}

}  // namespace
}  // namespace rc10::link::test::interface_lock_test
