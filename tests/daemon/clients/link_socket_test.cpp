#include "daemon/clients/link_socket.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "daemon/link_rig.hpp"

namespace rc10::test::link_socket_test {
namespace {

using ::testing::HasSubstr;

class LinkSocketTest : public ::testing::Test {
 protected:
  [[nodiscard]] bool accepts(const LinkSocket& socket) const {
    const TestClient client(socket.path());
    const UniqueFd accepted{::accept(socket.descriptor(), nullptr, nullptr)};
    return client.connected() && accepted;
  }

  TempDir dir;
};

TEST_F(LinkSocketTest, ListensUnderTheNameOfTheRobot) {
  const auto socket = LinkSocket::listen(dir.path(), "hero");
  ASSERT_TRUE(socket);
  EXPECT_EQ(socket->path(), dir / "hero.sock");
  EXPECT_TRUE(accepts(*socket));
}

TEST_F(LinkSocketTest, OnlyUserAndGroupMayConnect) {
  const auto socket = LinkSocket::listen(dir.path(), "hero");
  ASSERT_TRUE(socket);
  struct stat status {};
  ASSERT_EQ(::stat(socket->path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
}

TEST_F(LinkSocketTest, AProgramThatHoldsTheLockIsNotTakenForTheRc10dOfTheFile) {
  constexpr int kNoProcess = 999'999'999;  // beyond the kernel's PID_MAX_LIMIT
  std::ofstream(dir / "hero.lock") << kNoProcess;
  const UniqueFd other{::open((dir / "hero.lock").c_str(), O_RDONLY | O_CLOEXEC)};
  ASSERT_EQ(::flock(other.get(), LOCK_EX), 0);
  const auto socket = LinkSocket::listen(dir.path(), "hero");
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().message, HasSubstr("held by another program (`sudo fuser -v "));
}

TEST_F(LinkSocketTest, ASecondOneNamesThePidOfTheFirstAndLeavesItAlone) {
  const auto first = LinkSocket::listen(dir.path(), "hero");
  ASSERT_TRUE(first);
  const auto second = LinkSocket::listen(dir.path(), "hero");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("'hero'"));
  EXPECT_THAT(second.error().message, HasSubstr("pid " + std::to_string(::getpid()) + ")"));
  EXPECT_TRUE(accepts(*first));
}

TEST_F(LinkSocketTest, TwoRobotsShareOneFolder) {
  const auto hero = LinkSocket::listen(dir.path(), "hero");
  const auto sentry = LinkSocket::listen(dir.path(), "sentry");
  ASSERT_TRUE(hero && sentry);
  EXPECT_TRUE(accepts(*hero));
  EXPECT_TRUE(accepts(*sentry));
}

TEST_F(LinkSocketTest, TheSocketFileGoesWithItsOwnerAndTheNameIsFreeAgain) {
  std::string path;
  {
    auto socket = LinkSocket::listen(dir.path(), "hero");
    ASSERT_TRUE(socket);
    path = socket->path();
    const LinkSocket moved = std::move(*socket);
    EXPECT_TRUE(accepts(moved));
  }
  EXPECT_NE(::access(path.c_str(), F_OK), 0);
  EXPECT_TRUE(LinkSocket::listen(dir.path(), "hero"));
}

TEST_F(LinkSocketTest, ASocketFileLeftByOneThatWasKilledIsReplaced) {
  {
    const UniqueFd left{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    (dir / "hero.sock").copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(left.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    std::ofstream(dir / "hero.lock") << "1234567890123";  // longer than any pid: must not shine through
  }
  ASSERT_FALSE(TestClient(dir / "hero.sock").connected());
  const auto socket = LinkSocket::listen(dir.path(), "hero");
  ASSERT_TRUE(socket);
  EXPECT_TRUE(accepts(*socket));
  EXPECT_THAT(LinkSocket::listen(dir.path(), "hero").error().message,
              HasSubstr("pid " + std::to_string(::getpid()) + ")"));
}

TEST_F(LinkSocketTest, NobodyElseMayOpenTheLockAndSoHoldIt) {
  { std::ofstream(dir / "hero.lock") << "1"; }
  std::filesystem::permissions(dir / "hero.lock", std::filesystem::perms{0644});
  const auto hero = LinkSocket::listen(dir.path(), "hero");
  const auto sentry = LinkSocket::listen(dir.path(), "sentry");
  ASSERT_TRUE(hero && sentry);
  EXPECT_EQ(std::filesystem::status(dir / "hero.lock").permissions(), std::filesystem::perms{0600});
  EXPECT_EQ(std::filesystem::status(dir / "sentry.lock").permissions(), std::filesystem::perms{0600});
}

TEST_F(LinkSocketTest, MakesTheFolder) { EXPECT_TRUE(LinkSocket::listen(dir / "run", "hero")); }

TEST_F(LinkSocketTest, AFolderThatCannotBeMadeIsNamedWithTheRemedy) {
  const auto socket = LinkSocket::listen(dir / "no/such", "hero");
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().message, HasSubstr(dir / "no/such"));
  EXPECT_THAT(socket.error().message, HasSubstr("RC10_RUN_DIR"));
}

TEST_F(LinkSocketTest, APathTooLongForASocketIsRefusedAndNotCutOff) {
  const auto long_dir = dir / std::string(100, 'x');
  const auto socket = LinkSocket::listen(long_dir, "hero");
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().message, HasSubstr("107 bytes"));
}

}  // namespace
}  // namespace rc10::test::link_socket_test
