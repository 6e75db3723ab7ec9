// Without a guard; with one: tests/kernel/test_guard.py.
#include "daemon/guard_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <thread>

#include "link/run_dir.hpp"
#include "link/unix_address.hpp"

namespace rc10::test::guard_process_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StrEq;

/// The socket of a guard that takes no connection.
class SilentGuard {
 public:
  explicit SilentGuard(const std::string& run_dir) : path_(link::guardSocketPath(run_dir)) {
    const auto address = link::unixAddress(path_).value();
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(socket_.get(), 1), 0);
  }
  ~SilentGuard() { (void)::unlink(path_.c_str()); }
  SilentGuard(const SilentGuard&) = delete;
  SilentGuard& operator=(const SilentGuard&) = delete;

 protected:
  [[nodiscard]] int socket() const { return socket_.get(); }

 private:
  std::string path_;
  UniqueFd socket_{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
};

/// Says that it watches the first rc10d that comes.
class ObedientGuard : public SilentGuard {
 public:
  explicit ObedientGuard(const std::string& run_dir) : SilentGuard(run_dir) {
    thread_ = std::thread([this] {
      connection_ = UniqueFd{::accept(socket(), nullptr, nullptr)};
      std::array<char, 256> hello{};
      EXPECT_GT(::recv(connection_.get(), hello.data(), hello.size(), 0), 0);
      EXPECT_GT(::send(connection_.get(), link::kGuardArmed.data(), link::kGuardArmed.size(), 0), 0);
    });
  }
  ~ObedientGuard() {
    (void)::shutdown(socket(), SHUT_RDWR);  // nobody came
    thread_.join();
  }

 private:
  UniqueFd connection_;
  std::thread thread_;
};

class GuardProcessTest : public testing::Test {
 protected:
  GuardProcessTest() {
    if (::mkdtemp(dir.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  }
  ~GuardProcessTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(dir, ignored);
  }
  /// Its guard has just ended, and the next one would be this program.
  [[nodiscard]] std::unique_ptr<GuardProcess> lost(const std::string& program) const {
    std::unique_ptr<GuardProcess> link;
    {
      const ObedientGuard guard{dir};
      link = with(program).value();
    }
    EXPECT_TRUE(link->supervise(kEnd).lost);
    return link;
  }
  [[nodiscard]] Result<std::unique_ptr<GuardProcess>> with(const std::string& program) const {
    return GuardProcess::create({.run_dir = dir,
                                 .program = program,
                                 .hello = {.robot = "hero", .standstill_ms = 20, .rest_frames = ""}});
  }

  static constexpr MonotonicTime kEnd{100s};
  std::string dir = "/tmp/rc10-test-XXXXXX";
};

TEST_F(GuardProcessTest, AGuardThatEndsAtOnceIsNotWaitedForForEver) {
  const auto link = with("/bin/false");
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error().message,
              StrEq("/bin/false was started and does not answer at " + dir + "/guard.socket"));
}

TEST_F(GuardProcessTest, AGuardThatIsNotInstalledIsNamed) {
  const auto link = with(dir + "/rc10-guard");
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error().message, HasSubstr(dir + "/rc10-guard could not be started: No such file"));
}

TEST_F(GuardProcessTest, OneThatDoesNotComeIsTriedForAtGrowingDistancesAndToldOnce) {
  const auto link = lost(dir + "/rc10-guard");
  EXPECT_THAT(link->supervise(kEnd).text, HasSubstr("could not be started"));
  // Pauses of 1, 2, 4, 5 and 5 s.
  for (const auto at : {1s, 3s, 7s, 12s}) EXPECT_THAT(link->supervise(kEnd + at).text, IsEmpty());
  const ObedientGuard guard{dir};
  EXPECT_THAT(link->supervise(kEnd + 17s - 1ns).text, IsEmpty());
  EXPECT_EQ(link->descriptor(), -1) << "not tried yet";
  std::string told;
  while ((told = link->supervise(kEnd + 17s).text).empty()) {
    pollfd answer{.fd = link->descriptor(), .events = POLLIN, .revents = 0};
    ASSERT_EQ(::poll(&answer, 1, -1), 1);
  }
  EXPECT_EQ(told, "rc10-guard watches again");
}

TEST_F(GuardProcessTest, TheNextEndIsToldAnew) {
  const auto link = lost(dir + "/rc10-guard");
  const auto first = link->supervise(kEnd).text;
  {
    const ObedientGuard guard{dir};
    while (link->supervise(kEnd + 1s).text.empty()) {
      pollfd answer{.fd = link->descriptor(), .events = POLLIN, .revents = 0};
      ASSERT_EQ(::poll(&answer, 1, -1), 1);
    }
  }
  EXPECT_TRUE(link->supervise(kEnd + 2s).lost);
  EXPECT_EQ(link->supervise(kEnd + 2s).text, first);
}

// The time of these tests stands still while one waits.
TEST_F(GuardProcessTest, OneThatWasStartedIsNotWaitedForInSupervise) {
  const auto link = lost("/bin/false");
  EXPECT_THAT(link->supervise(kEnd).text, IsEmpty());
  EXPECT_THAT(link->supervise(kEnd + 1s - 1ns).text, IsEmpty());
  EXPECT_THAT(link->supervise(kEnd + 1s).text, HasSubstr("was started and does not answer"));
}

TEST_F(GuardProcessTest, TheAnswerIsNotWaitedForInSupervise) {
  const auto link = lost(dir + "/rc10-guard");
  const SilentGuard guard{dir};
  EXPECT_THAT(link->supervise(kEnd).text, IsEmpty());
  EXPECT_NE(link->descriptor(), -1) << "its answer wakes the main thread";
  EXPECT_THAT(link->supervise(kEnd + 1s - 1ns).text, IsEmpty());
  EXPECT_EQ(link->supervise(kEnd + 1s).text, "rc10-guard does not answer");
  EXPECT_EQ(link->descriptor(), -1);
}

}  // namespace
}  // namespace rc10::test::guard_process_test
