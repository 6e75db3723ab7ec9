#include "daemon/service_notify.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <iterator>

#include "app/unique_fd.hpp"
#include "daemon/temp_dir.hpp"
#include "support/without_descriptors.hpp"

namespace rc10::test::service_notify_test {
namespace {

/// The socket of systemd. `name` begins with '@' in the abstract namespace.
class Systemd {
 public:
  explicit Systemd(const std::string& name) : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path, sizeof address.sun_path - 1);
    if (name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), size), 0) << name;
  }
  /// The next message that is already there; "" without one.
  [[nodiscard]] std::string take() const {
    std::array<char, 256> text{};
    const auto size = ::recv(fd_.get(), text.data(), text.size(), MSG_DONTWAIT);
    return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "";
  }

 private:
  UniqueFd fd_;
};

std::ptrdiff_t openFds() {
  using Directory = std::filesystem::directory_iterator;
  return std::distance(Directory{"/proc/self/fd"}, Directory{});
}

class ServiceNotifyTest : public ::testing::Test {
 protected:
  ~ServiceNotifyTest() override { ::unsetenv("NOTIFY_SOCKET"); }
  static void setSocket(const std::string& path) { ::setenv("NOTIFY_SOCKET", path.c_str(), 1); }

  TempDir dir;
};

TEST_F(ServiceNotifyTest, SendsOneMessageForEachState) {
  const Systemd systemd(dir / "notify");
  setSocket(dir / "notify");
  notifyService("READY=1");
  notifyService("WATCHDOG=1");
  EXPECT_EQ(systemd.take(), "READY=1");
  EXPECT_EQ(systemd.take(), "WATCHDOG=1");
  EXPECT_EQ(systemd.take(), "");
}

TEST_F(ServiceNotifyTest, FeedsTheWatchdogWithoutDescriptors) {
  const Systemd systemd(dir / "notify");
  setSocket(dir / "notify");
  notifyService("READY=1");
  {
    const WithoutDescriptors none;
    notifyService("WATCHDOG=1");
  }
  EXPECT_EQ(systemd.take(), "READY=1");
  EXPECT_EQ(systemd.take(), "WATCHDOG=1");
}

TEST_F(ServiceNotifyTest, KnowsTheAbstractNamespace) {
  const std::string name = "@rc10-test-notify-" + std::to_string(::getpid());
  const Systemd systemd(name);
  setSocket(name);
  notifyService("READY=1");
  EXPECT_EQ(systemd.take(), "READY=1");
}

TEST_F(ServiceNotifyTest, DoesNothingWhenNotRunBySystemd) {
  const Systemd systemd(dir / "notify");
  ::unsetenv("NOTIFY_SOCKET");
  notifyService("READY=1");
  EXPECT_EQ(systemd.take(), "");
}

TEST_F(ServiceNotifyTest, IgnoresAnAddressThatIsNoSocketPath) {
  const Systemd systemd(dir / "notify");
  const auto before = openFds();
  for (const auto& path : {std::string{}, std::string{"relative"}, "/" + std::string(200, 'x')}) {
    setSocket(path);
    notifyService("READY=1");
    EXPECT_EQ(openFds(), before) << path;
  }
  EXPECT_EQ(systemd.take(), "");
  setSocket(dir / "notify");
  notifyService("WATCHDOG=1");
  EXPECT_EQ(systemd.take(), "WATCHDOG=1");
}

TEST_F(ServiceNotifyTest, AMessageToNobodyIsLostAndTheNextIsHeard) {
  setSocket(dir / "nobody");
  notifyService("READY=1");
  const auto before = openFds();  // with the socket, which is kept
  notifyService("STATUS=1");
  EXPECT_EQ(openFds(), before);
  const Systemd systemd(dir / "nobody");
  notifyService("WATCHDOG=1");
  EXPECT_EQ(systemd.take(), "WATCHDOG=1");
  EXPECT_EQ(systemd.take(), "");
}

TEST_F(ServiceNotifyTest, NeverWaitsForOneThatDoesNotRead) {
  const Systemd systemd(dir / "notify");
  setSocket(dir / "notify");
  for (int i = 0; i < 2000; ++i) notifyService("WATCHDOG=1");  // more than the queue of any socket holds
  EXPECT_EQ(systemd.take(), "WATCHDOG=1");
}

}  // namespace
}  // namespace rc10::test::service_notify_test
