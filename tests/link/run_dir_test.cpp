#include "link/run_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "daemon/temp_dir.hpp"

namespace rc10::link::test::run_dir_test {
namespace {

class RunDir : public testing::Test {
 protected:
  RunDir() {
    if (const char* dir = std::getenv("RC10_RUN_DIR")) before_ = dir;
  }
  ~RunDir() override { ::setenv("RC10_RUN_DIR", before_.c_str(), 1); }

 private:
  std::string before_;
};

TEST_F(RunDir, IsTheEnvironmentsChoice) {
  ::setenv("RC10_RUN_DIR", "/somewhere", 1);
  EXPECT_EQ(runDir(), "/somewhere");
  EXPECT_EQ(socketPath("hero"), "/somewhere/hero.sock");
}

TEST_F(RunDir, IsTheSystemsWithoutOne) {
  ::unsetenv("RC10_RUN_DIR");
  EXPECT_EQ(runDir(), "/run/rc10d");
  ::setenv("RC10_RUN_DIR", "", 1);
  EXPECT_EQ(socketPath("hero"), "/run/rc10d/hero.sock");
}

std::string refusal(const std::string& dir, uid_t user = ::geteuid()) {
  const auto made = makeRunDir(dir, user);
  return made ? "" : made.error().message;
}

using ::testing::HasSubstr;

TEST(MakeRunDir, MakesItAndTakesTheOneThatIsThere) {
  const rc10::test::TempDir folder;
  EXPECT_EQ(refusal(folder / "run"), "");
  EXPECT_EQ(refusal(folder / "run"), "");
}

TEST(MakeRunDir, RefusesOneThatEveryUserMayWriteTo) {
  const rc10::test::TempDir folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  EXPECT_THAT(refusal(folder.path()), HasSubstr("every user may write to it: set RC10_RUN_DIR"));
}

TEST(MakeRunDir, RefusesOneThatAGroupOfOthersMayWriteTo) {
  const rc10::test::TempDir folder;
  // It takes root to give a folder away.
  const bool given = ::chown(folder.path().c_str(), static_cast<uid_t>(-1), ::geteuid() + 1) == 0;
  const bool of_others = given || ::getegid() != ::geteuid();
  ASSERT_EQ(::chmod(folder.path().c_str(), 0770), 0);
  EXPECT_THAT(refusal(folder.path()),
              of_others ? testing::Matcher<std::string>(HasSubstr("replace sockets: `chmod g-w ")) : "");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0750), 0);
  EXPECT_EQ(refusal(folder.path()), "");
}

TEST(MakeRunDir, RefusesALinkAndAFile) {
  const rc10::test::TempDir folder;
  ASSERT_EQ(::symlink("/tmp", (folder / "link").c_str()), 0);
  EXPECT_THAT(refusal(folder / "link"), HasSubstr("is no folder of its own"));
  EXPECT_THAT(refusal("/etc/passwd"), HasSubstr("is no folder of its own"));
}

// As root one that was given away; else this user's, seen by another one.
TEST(MakeRunDir, RefusesAnotherUsers) {
  const rc10::test::TempDir folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  ASSERT_EQ(::mkdir((folder / "run").c_str(), 0755), 0);
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown((folder / "run").c_str(), 12345, 12345), 0);
  }
  EXPECT_THAT(refusal(folder / "run", ::geteuid() + 1), HasSubstr("belongs to another user (uid "));
}

// As systemd does for the service, and as /proc is made.
TEST(MakeRunDir, TakesAnotherUsersWhereOnlyRootCouldHavePutIt) {
  const rc10::test::TempDir folder;
  std::string dir = "/proc/" + std::to_string(::getpid());
  if (::geteuid() == 0) {
    dir = folder / "run";
    ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
    ASSERT_EQ(::mkdir(dir.c_str(), 0755), 0);
    ASSERT_EQ(::chown(dir.c_str(), 12345, 12345), 0);
  }
  EXPECT_EQ(refusal(dir, ::geteuid() + 1), "");
}

TEST(MakeRunDir, SaysWhatToDoWhereNothingMayBeMade) {
  EXPECT_THAT(refusal("/proc/rc10"), HasSubstr("set RC10_RUN_DIR to a folder of this user"));
}

}  // namespace
}  // namespace rc10::link::test::run_dir_test
