#include "web/running_config.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "config/sha256.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::web::test::running_config_test {
namespace {

class RunningConfigTest : public ::testing::Test {
 protected:
  void leave(const std::string& name, const std::string& text, int age_s = 0) {
    const auto path = run / name;
    std::ofstream{path} << text;
    std::filesystem::last_write_time(path, now_ - std::chrono::seconds{age_s});
  }
  rc10::test::TempDir run;

 private:
  std::filesystem::file_time_type now_ = std::filesystem::file_time_type::clock::now();
};

TEST_F(RunningConfigTest, OfARobotThatRunsItIsTheCopyWithItsHash) {
  leave("hero.config", "robot: hero\n");
  const auto found = readRunningConfig(run.path(), "hero", sha256("robot: hero\n"));
  EXPECT_EQ(found.of, "running");
  EXPECT_EQ(found.text, "robot: hero\n");
  EXPECT_EQ(readRunningConfig(run.path(), "hero", sha256("another")).text, "");
  EXPECT_EQ(readRunningConfig(run.path(), "sentry", sha256("robot: hero\n")).text, "");
}

TEST_F(RunningConfigTest, WithoutARobotTheRefusedFileComesBeforeAnOlderOne) {
  EXPECT_EQ(readLastConfig(run.path(), std::nullopt).of, "none");
  leave("hero.config", "old", 20);
  leave("sentry.config", "newer", 10);
  EXPECT_EQ(readLastConfig(run.path(), std::nullopt).text, "newer");
  EXPECT_EQ(readLastConfig(run.path(), "hero").text, "old");
  leave("robot.refused", "wrong");
  EXPECT_EQ(readLastConfig(run.path(), std::nullopt).of, "refused");
  leave("sentry.config", "mended", -10);
  EXPECT_EQ(readLastConfig(run.path(), std::nullopt).text, "mended");
}

TEST_F(RunningConfigTest, TheRightsOfARobotAreInItsOwnFileAndOfSeveralRobotsInNone) {
  const auto accepted = [&](const std::optional<std::string>& robot) {
    const auto found = readAcceptedConfig(run.path(), robot);
    return found ? found->robot + ": " + found->text : "nobody knows";
  };
  leave("hero.config", "strict", 20);
  leave("robot.refused", "wrong");
  EXPECT_EQ(accepted(std::nullopt), "hero: strict");
  leave("arm.config", "for everybody");
  EXPECT_EQ(accepted(std::nullopt), "nobody knows");
  EXPECT_EQ(accepted("hero"), "hero: strict");
  EXPECT_EQ(accepted("sentry"), "nobody knows");
  EXPECT_EQ(accepted("../hero"), "nobody knows");
}

TEST_F(RunningConfigTest, ARefusedFileOfAnotherRobotIsNotThatOfTheNamedOne) {
  leave("hero.config", "robot: hero\n", 20);
  leave("sentry.refused", "robot: sentry\n");
  EXPECT_EQ(readLastConfig(run.path(), "hero").text, "robot: hero\n");
  EXPECT_EQ(readLastConfig(run.path(), "sentry").of, "refused");
}

TEST_F(RunningConfigTest, NeitherALinkNorAPipeNorAPathIsRead) {
  leave("secret", "secret");
  std::filesystem::create_symlink(run / "secret", run / "hero.config");
  ASSERT_EQ(::mkfifo((run / "sentry.config").c_str(), 0600), 0);
  EXPECT_EQ(readRunningConfig(run.path(), "hero", sha256("secret")).text, "");
  EXPECT_EQ(readRunningConfig(run.path(), "sentry", "").text, "");
  EXPECT_EQ(readRunningConfig(run.path(), "../hero", "").text, "");
  EXPECT_EQ(readLastConfig(run.path(), "../secret").text, "");
}

}  // namespace
}  // namespace rc10::web::test::running_config_test
