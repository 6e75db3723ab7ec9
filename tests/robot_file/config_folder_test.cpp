#include "robot_file/config_folder.hpp"

#include <sys/stat.h>

#include <gmock/gmock.h>

#include "robot_file/folder.hpp"

namespace rc10::robot_file::test::config_folder_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// 2026-11-26T15:04:05Z
constexpr std::time_t kNow = 1795705445;

ConfigFolder opened(const Folder& folder) { return ConfigFolder::open(folder.path()).value(); }

TEST(ConfigFolder, ReplacesAFileAndKeepsTheOldOneUnderItsDate) {
  const Folder folder;
  folder.write("robot.yaml", "old");
  const auto backup = opened(folder).replace("robot.yaml", "new", kNow);
  ASSERT_TRUE(backup) << backup.error().message;
  EXPECT_EQ(*backup, "robot.yaml.2026-11-26T15-04-05Z");
  EXPECT_EQ(folder.read("robot.yaml"), "new");
  EXPECT_EQ(folder.read(*backup), "old");
  EXPECT_THAT(folder.files(), ElementsAre("robot.yaml", *backup));
}

TEST(ConfigFolder, TheModeOfAFileStays) {
  const Folder folder;
  folder.write("robot.yaml", "old");
  ASSERT_EQ(::chmod(folder.pathOf("robot.yaml").c_str(), 0640), 0);
  ASSERT_TRUE(opened(folder).replace("robot.yaml", "new", kNow));
  struct stat status {};
  ASSERT_EQ(::stat(folder.pathOf("robot.yaml").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0640U);
}

TEST(ConfigFolder, AFirstFileHasNoBackup) {
  const Folder folder;
  EXPECT_EQ(opened(folder).replace("robot.yaml", "new", kNow).value(), "");
  EXPECT_THAT(folder.files(), ElementsAre("robot.yaml"));
}

TEST(ConfigFolder, TwoInOneSecondKeepBothOldFiles) {
  const Folder folder;
  folder.write("robot.yaml", "first");
  const auto one = opened(folder).replace("robot.yaml", "second", kNow).value();
  const auto two = opened(folder).replace("robot.yaml", "third", kNow).value();
  EXPECT_EQ(folder.read(one), "first");
  EXPECT_EQ(folder.read(two), "second");
}

TEST(ConfigFolder, TheNewestBackupsOfThisFileStay) {
  const Folder folder;
  folder.write("robot.yaml", "0");
  folder.write("robot.yaml.~1~", "by hand");
  folder.write("other.yaml.2020-01-01T00-00-00Z", "of another");
  for (std::size_t i = 1; i <= ConfigFolder::kBackups + 3; ++i)
    ASSERT_TRUE(opened(folder).replace("robot.yaml", std::to_string(i), kNow + static_cast<std::time_t>(i)));
  EXPECT_EQ(folder.files().size(), ConfigFolder::kBackups + 3);
  EXPECT_EQ(folder.read("robot.yaml.2026-11-26T15-04-08Z"), "");  // the oldest, of "2", is gone
  EXPECT_EQ(folder.read("robot.yaml.~1~"), "by hand");
}

TEST(ConfigFolder, TheLastBackupIsTheNewestThoughTheClockWasSetBack) {
  const Folder folder;
  folder.write("robot.yaml", "0");
  for (std::size_t i = 1; i <= ConfigFolder::kBackups; ++i)
    ASSERT_TRUE(opened(folder).replace("robot.yaml", std::to_string(i), kNow + static_cast<std::time_t>(i)));
  // A computer that has lost its time thinks that it is 1970.
  const auto one = opened(folder).replace("robot.yaml", "one", 12).value();
  const auto two = opened(folder).replace("robot.yaml", "two", 13).value();
  EXPECT_EQ(folder.read(one), std::to_string(ConfigFolder::kBackups));
  EXPECT_EQ(folder.read(two), "one");
  EXPECT_LT(one, two);
  EXPECT_EQ(folder.files().size(), ConfigFolder::kBackups + 1);
}

TEST(ConfigFolder, WhatIsNoBackupOfItsOwnStays) {
  const Folder folder;
  folder.write("robot.yaml", "0");
  const std::vector<std::string> own{"robot.yaml.2025-regionalZ", "robot.yaml.2025-01-32T00-00-00Z",
                                     "robot.yaml.2025-01-01T00-00-00Z.bak"};
  for (const auto& name : own) folder.write(name, "by hand");
  for (std::size_t i = 1; i <= ConfigFolder::kBackups + 3; ++i)
    ASSERT_TRUE(opened(folder).replace("robot.yaml", std::to_string(i), kNow + static_cast<std::time_t>(i)));
  for (const auto& name : own) EXPECT_EQ(folder.read(name), "by hand") << name;
}

TEST(ConfigFolder, ALinkIsNeitherReadNorReplaced) {
  const Folder folder;
  folder.write("secret", "secret");
  std::filesystem::create_symlink("secret", folder.pathOf("robot.yaml"));
  const auto read = opened(folder).read("robot.yaml");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("is a link"));
  EXPECT_FALSE(opened(folder).replace("robot.yaml", "new", kNow));
  EXPECT_EQ(folder.read("secret"), "secret");
  EXPECT_THAT(folder.files(), ElementsAre("robot.yaml", "secret"));
}

TEST(ConfigFolder, AHalfWrittenTextOfALostPowerIsInNobodysWay) {
  const Folder folder;
  folder.write("robot.yaml", "old");
  folder.write(".robot.yaml.new", "half");
  ASSERT_TRUE(opened(folder).replace("robot.yaml", "new", kNow));
  EXPECT_EQ(folder.read("robot.yaml"), "new");
  EXPECT_EQ(folder.read(".robot.yaml.new"), "");
}

TEST(ConfigFolder, AFileThatIsNotThereHasNoText) {
  const Folder folder;
  EXPECT_EQ(opened(folder).read("robot.yaml").value(), std::nullopt);
  EXPECT_FALSE(ConfigFolder::open(folder.pathOf("nowhere")));
}

}  // namespace
}  // namespace rc10::robot_file::test::config_folder_test
