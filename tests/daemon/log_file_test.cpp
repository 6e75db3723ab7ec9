#include "daemon/log_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include <spdlog/logger.h>

#include "app/whole_file.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::test::log_file_test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

class LogFileTest : public ::testing::Test {
 protected:
  LogFileTest() { log.set_pattern("%v"); }
  [[nodiscard]] std::string text(const std::string& name = "robot.log") const {
    return readWholeFile(dir / name).value_or("");
  }

  TempDir dir;
  std::shared_ptr<LogFile> file = std::make_shared<LogFile>();
  spdlog::logger log{"test", file};
};

TEST_F(LogFileTest, EachLineIsThereAtOnceThoseFromBeforeFirst) {
  log.info("before");
  file->keepIn(dir / "robot.log");
  log.info("after");
  EXPECT_EQ(text(), "before\nafter\n");
}

TEST_F(LogFileTest, ItIsForItsOwnerAndGroup) {
  file->keepIn(dir / "robot.log");
  struct stat status {};
  ASSERT_EQ(::stat((dir / "robot.log").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & (S_IRWXO | S_IWGRP | S_IXGRP), 0U);
}

TEST_F(LogFileTest, ManyLinesTakeBoundedRoomAndTheLastOnesStay) {
  file->keepIn(dir / "robot.log");
  for (int i = 0; i < 10'000; ++i) log.info("line {}", i);
  EXPECT_LE(std::filesystem::file_size(dir / "robot.log"), LogFile::kMostBytes);
  EXPECT_LE(std::filesystem::file_size(dir / "robot.log.1"), LogFile::kMostBytes);
  EXPECT_THAT(text("robot.log.1") + text(), EndsWith("line 9998\nline 9999\n"));
  EXPECT_GT(text("robot.log.1").size(), LogFile::kMostBytes / 2);
}

TEST_F(LogFileTest, ANewRunBeginsWithNothingOfTheLastOne) {
  file->keepIn(dir / "robot.log");
  for (int i = 0; i < 10'000; ++i) log.info("old {}", i);
  const auto next = std::make_shared<LogFile>();
  next->keepIn(dir / "robot.log");
  EXPECT_EQ(text(), "");
  EXPECT_FALSE(std::filesystem::exists(dir / "robot.log.1"));
}

TEST_F(LogFileTest, ALinkInItsPlaceIsNotFollowed) {
  ASSERT_EQ(::symlink((dir / "other").c_str(), (dir / "robot.log").c_str()), 0);
  file->keepIn(dir / "robot.log");
  log.info("line");
  EXPECT_EQ(text(), "line\n");
  EXPECT_FALSE(std::filesystem::exists(dir / "other"));
}

TEST_F(LogFileTest, AFolderThatIsGoneCostsNothingButTheLines) {
  file->keepIn(dir / "nowhere/robot.log");
  log.info("line");
  EXPECT_THAT(text(), testing::Not(HasSubstr("line")));
}

}  // namespace
}  // namespace rc10::test::log_file_test
