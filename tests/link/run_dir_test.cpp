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

std::string refusal(const std::string& dir) {
  const auto made = makeRunDir(dir);
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

TEST(MakeRunDir, RefusesALinkAndAFile) {
  const rc10::test::TempDir folder;
  ASSERT_EQ(::symlink("/tmp", (folder / "link").c_str()), 0);
  EXPECT_THAT(refusal(folder / "link"), HasSubstr("is no folder of its own"));
  EXPECT_THAT(refusal("/etc/passwd"), HasSubstr("is no folder of its own"));
}

TEST(MakeRunDir, RefusesAnotherUsersExceptWhereRootPutIt) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root gives folders away";
  const rc10::test::TempDir folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(::mkdir((folder / "run").c_str(), 0755), 0);
  ASSERT_EQ(::chown((folder / "run").c_str(), 12345, 12345), 0);
  EXPECT_EQ(refusal(folder / "run"), "") << "as systemd does for the service";
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  EXPECT_THAT(refusal(folder / "run"), HasSubstr("belongs to another user (uid 12345)"));
}

TEST(MakeRunDir, SaysWhatToDoWhereNothingMayBeMade) {
  EXPECT_THAT(refusal("/proc/rc10"), HasSubstr("set RC10_RUN_DIR to a folder of this user"));
}

}  // namespace
}  // namespace rc10::link::test::run_dir_test
