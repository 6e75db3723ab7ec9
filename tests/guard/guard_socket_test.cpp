#include "guard/guard_socket.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "link/run_dir.hpp"
#include "link/unix_address.hpp"
#include "support/without_descriptors.hpp"

namespace rc10::guard::test::guard_socket_test {
namespace {

using ::testing::HasSubstr;

class GuardSocketTest : public testing::Test {
 protected:
  GuardSocketTest() {
    if (::mkdtemp(dir.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  }
  ~GuardSocketTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(dir, ignored);
  }
  [[nodiscard]] bool there() const { return std::filesystem::exists(link::guardSocketPath(dir)); }

  std::string dir = "/tmp/rc10-test-XXXXXX";
};

TEST_F(GuardSocketTest, ThereIsOneGuardInARunFolder) {
  const auto first = GuardSocket::listen(dir);
  ASSERT_TRUE(first);
  const auto second = GuardSocket::listen(dir);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("another rc10-guard in " + dir));
  EXPECT_TRUE(there());
}

TEST_F(GuardSocketTest, LeavesNothingBehindThatLooksLikeAGuard) {
  { const auto guard = GuardSocket::listen(dir); }
  EXPECT_FALSE(there());
  EXPECT_TRUE(GuardSocket::listen(dir));
}

TEST_F(GuardSocketTest, HasNoFileThatARobotOfItsNameWouldHave) {
  const auto guard = GuardSocket::listen(dir);
  for (const auto& entry : std::filesystem::directory_iterator(dir)) {
    EXPECT_NE(entry.path().filename(), "guard.sock");
    EXPECT_NE(entry.path().filename(), "guard.lock");
    EXPECT_NE(entry.path().extension(), ".sock") << "rc10ctl would take it for a robot";
  }
}

TEST_F(GuardSocketTest, IsForItsOwnUserAlone) {
  const auto guard = GuardSocket::listen(dir);
  const auto mode = std::filesystem::status(link::guardSocketPath(dir)).permissions();
  EXPECT_EQ(mode, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(GuardSocketTest, WithoutDescriptorsAVisitorIsSentAwayAndTheNextIsServed) {
  auto guard = GuardSocket::listen(dir);
  ASSERT_TRUE(guard);
  const auto address = link::unixAddress(link::guardSocketPath(dir));
  const auto visit = [&address] {
    UniqueFd visitor{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
    EXPECT_EQ(::connect(visitor.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address), 0);
    return visitor;
  };
  const auto late = visit();
  std::optional<rc10::test::WithoutDescriptors> none;
  none.emplace();
  const auto refused = guard->accept();
  const auto empty = guard->accept();
  none.reset();
  EXPECT_FALSE(refused.connection);
  EXPECT_TRUE(refused.sent_away);
  EXPECT_FALSE(empty.sent_away) << "nobody waits any more, and nothing wakes the guard";
  char byte = 0;
  EXPECT_EQ(::recv(late.get(), &byte, 1, 0), 0) << "it is told by its end";
  const auto next = visit();
  EXPECT_TRUE(guard->accept().connection);
}

TEST_F(GuardSocketTest, AFolderThatCannotBeMadeIsNamed) {
  const auto guard = GuardSocket::listen(dir + "/no/such");
  ASSERT_FALSE(guard);
  EXPECT_THAT(guard.error().message, HasSubstr(dir + "/no/such: No such file"));
}

}  // namespace
}  // namespace rc10::guard::test::guard_socket_test
