#include "web/daemon_end.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "daemon/temp_dir.hpp"

namespace rc10::test::daemon_end_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

class DaemonEndTest : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text, std::int64_t written = 1'000'000) const {
    std::ofstream{dir / name} << text;
    const timespec time{.tv_sec = written, .tv_nsec = 0};
    const std::array times{time, time};
    ASSERT_EQ(::utimensat(AT_FDCWD, (dir / name).c_str(), times.data(), 0), 0);
  }
  [[nodiscard]] web::DaemonEnd end(const std::optional<std::string>& robot = {}) const {
    return web::readDaemonEnd(dir.path(), robot);
  }

  TempDir dir;
};

TEST_F(DaemonEndTest, AnEmptyFolderSaysNothing) {
  EXPECT_THAT(end().log, IsEmpty());
  EXPECT_THAT(end().refusal, IsEmpty());
  EXPECT_THAT(web::readDaemonEnd("/nowhere", {}).log, IsEmpty());
}

TEST_F(DaemonEndTest, TheLogIsOfTheNamedRobotOrTheOneHeardLast) {
  write("front.log", "front ends\n", 1000);
  write("rear.log", "rear ends\n", 2000);
  EXPECT_EQ(end().log, "rear ends\n");
  EXPECT_EQ(end().logged_at, 2000);
  EXPECT_EQ(end("front").log, "front ends\n");
  EXPECT_THAT(end("other").log, IsEmpty());
  EXPECT_THAT(end("../front").log, Not(HasSubstr("front")));
}

TEST_F(DaemonEndTest, ALongLogIsItsLastWholeLines) {
  std::string lines;
  for (int i = 0; i < 2000; ++i) lines += "line " + std::to_string(i) + "\n";
  write("robot.log.1", lines);
  write("robot.log", "the end\n");
  const auto log = end().log;
  EXPECT_THAT(log, StartsWith("line "));
  EXPECT_THAT(log, HasSubstr("line 1999\nthe end\n"));
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 60);
}

TEST_F(DaemonEndTest, ALineWithoutAnEndIsBounded) {
  write("robot.log", std::string(100'000, 'x'));
  EXPECT_LE(end().log.size(), std::size_t{16} << 10U);
}

TEST_F(DaemonEndTest, ARefusalFromBeforeTheLastRunIsOver) {
  write("robot.refusal", "robot.yaml: 1 error\n", 2000);
  EXPECT_EQ(end().refusal, "robot.yaml: 1 error\n");
  EXPECT_EQ(end().refused_at, 2000);
  write("robot.log", "it ran\n", 2005);
  EXPECT_THAT(end().refusal, HasSubstr("1 error")) << "its own start wrote these lines";
  write("robot.log", "it ran\n", 3000);
  EXPECT_THAT(end().refusal, IsEmpty());
}

TEST_F(DaemonEndTest, ARefusalOfAnotherRobotIsNotThatOfTheNamedOne) {
  write("rear.refused", "# rear\nrobot: 'rear'  # its name\nbuses: [\n", 2000);
  write("rear.refusal", "rear.yaml: 1 error\n", 2000);
  EXPECT_EQ(end().refusal, "rear.yaml: 1 error\n");
  EXPECT_EQ(end("rear").refusal, "rear.yaml: 1 error\n");
  EXPECT_THAT(end("front").refusal, IsEmpty());
  write("front.refused", "robot: front\n", 1000);
  write("front.refusal", "front.yaml: 2 errors\n", 1000);
  EXPECT_EQ(end("front").refusal, "front.yaml: 2 errors\n") << "an older one, and its own";
}

TEST_F(DaemonEndTest, ARefusalThatNamesNoRobotMayBeOfAny) {
  write("robot.refusal", "robot.yaml: 1 error\n", 2000);
  EXPECT_EQ(end("front").refusal, "robot.yaml: 1 error\n");
  write("robot.refused", "  robot: rear\n", 2000);
  EXPECT_EQ(end("front").refusal, "robot.yaml: 1 error\n");
}

TEST_F(DaemonEndTest, LinksAndWhatIsNoFileAreNotRead) {
  write("secret", "secret\n");
  ASSERT_EQ(::symlink((dir / "secret").c_str(), (dir / "robot.log").c_str()), 0);
  ASSERT_EQ(::mkfifo((dir / "robot.refusal").c_str(), 0600), 0);
  EXPECT_THAT(end().log, IsEmpty());
  EXPECT_THAT(end("robot").log, IsEmpty());
  EXPECT_THAT(end().refusal, IsEmpty());
}

}  // namespace
}  // namespace rc10::test::daemon_end_test
