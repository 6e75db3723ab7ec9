#include "link/interface_lock.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>

namespace rc10::link::test::interface_lock_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StrEq;

class InterfaceLockTest : public testing::Test {
 protected:
  InterfaceLockTest() {
    if (::mkdtemp(dir.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  }
  ~InterfaceLockTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(dir, ignored);
  }

  static std::string here(const std::string& robot) {
    return "robot '" + robot + "' (rc10d, pid " + std::to_string(::getpid()) + ")";
  }

  std::string dir = "/tmp/rc10-test-XXXXXX";
};

TEST_F(InterfaceLockTest, ASecondRobotIsToldWhoDrivesTheInterface) {
  const auto first = InterfaceLock::take(dir, "can0", "hero");
  ASSERT_TRUE(first);
  const auto second = InterfaceLock::take(dir, "can0", "sentry");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, StrEq("can0 is driven by " + here("hero") + "; stop it first"));
}

TEST_F(InterfaceLockTest, ARefusedOneLeavesTheLockWithTheFirst) {
  const auto first = InterfaceLock::take(dir, "can0", "hero");
  ASSERT_TRUE(first);
  ASSERT_FALSE(InterfaceLock::take(dir, "can0", "sentry"));
  EXPECT_THAT(InterfaceLock::holder(dir, "can0"), StrEq(here("hero")));
}

TEST_F(InterfaceLockTest, OtherInterfacesAreFree) {
  const auto first = InterfaceLock::take(dir, "can0", "hero");
  const auto second = InterfaceLock::take(dir, "can1", "sentry");
  EXPECT_TRUE(first && second);
  EXPECT_THAT(InterfaceLock::holder(dir, "can2"), IsEmpty());
}

TEST_F(InterfaceLockTest, EndsWithItsOwner) {
  {
    auto lock = InterfaceLock::take(dir, "can0", "a_name_that_is_longer_than_others");
    ASSERT_TRUE(lock);
    const InterfaceLock moved = std::move(*lock);
    EXPECT_THAT(InterfaceLock::holder(dir, "can0"), HasSubstr("longer"));
  }
  EXPECT_THAT(InterfaceLock::holder(dir, "can0"), IsEmpty());
  const auto next = InterfaceLock::take(dir, "can0", "b");
  ASSERT_TRUE(next);
  EXPECT_THAT(InterfaceLock::holder(dir, "can0"), StrEq(here("b")));  // nothing of the longer one is left
}

TEST_F(InterfaceLockTest, EndsWithAProcessThatIsKilled) {
  const pid_t child = ::fork();
  if (child == 0) {
    static const auto lock = InterfaceLock::take(dir, "can0", "hero");
    ::kill(::getpid(), lock ? SIGKILL : SIGTERM);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(WTERMSIG(status), SIGKILL);
  EXPECT_THAT(InterfaceLock::holder(dir, "can0"), IsEmpty());
  EXPECT_TRUE(InterfaceLock::take(dir, "can0", "hero"));
}

TEST_F(InterfaceLockTest, IsNotInheritedByOtherPrograms) {
  const auto lock = InterfaceLock::take(dir, "can0", "hero");
  ASSERT_TRUE(lock);
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code ignored;
    if (std::filesystem::read_symlink(entry.path(), ignored) != InterfaceLock::path(dir, "can0")) continue;
    ++found;
    EXPECT_EQ(::fcntl(std::stoi(entry.path().filename()), F_GETFD), FD_CLOEXEC);
  }
  EXPECT_EQ(found, 1U);
}

TEST_F(InterfaceLockTest, NobodyHoldsAnythingWhereNothingEverRan) {
  EXPECT_THAT(InterfaceLock::holder(dir + "/no/such", "can0"), IsEmpty());
}

TEST_F(InterfaceLockTest, AFileOfStrangeContentIsNotPrintedAsItIs) {
  const auto lock = InterfaceLock::take(dir, "can0", "hero");
  ASSERT_TRUE(lock);
  std::ofstream(InterfaceLock::path(dir, "can0")) << "\x1b[2Jhero\nmore";
  EXPECT_THAT(InterfaceLock::holder(dir, "can0"), StrEq("?[2Jhero"));
  std::ofstream(InterfaceLock::path(dir, "can0")).flush();
  EXPECT_THAT(InterfaceLock::holder(dir, "can0"), StrEq("another rc10d"));
}

TEST_F(InterfaceLockTest, AFolderThatCannotBeMadeIsNamedWithTheRemedy) {
  const auto lock = InterfaceLock::take(dir + "/no/such", "can0", "hero");
  ASSERT_FALSE(lock);
  EXPECT_THAT(lock.error().message, HasSubstr(dir + "/no/such/locks"));
  EXPECT_THAT(lock.error().message, HasSubstr("RC10_RUN_DIR"));
}

}  // namespace
}  // namespace rc10::link::test::interface_lock_test
