// Over pseudo terminals, which are real ports to everything but the wire.
#include "bus/serial_port.hpp"

#include <asm/termbits.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <cerrno>
#include <filesystem>

#include "support/pty.hpp"

namespace rc10::test::serial_port_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// All that has been sent: before read() says EAGAIN the kernel fetches what is still on its way.
std::vector<std::uint8_t> readAll(int fd) {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, 64> part;
  for (ssize_t n; (n = ::read(fd, part.data(), part.size())) > 0;) {
    all.insert(all.end(), part.begin(), part.begin() + n);
  }
  return all;
}

/// While it lives, even root minds the rights of files.
class WithoutOverride {
 public:
  WithoutOverride() {
    EXPECT_EQ(::syscall(SYS_capget, &header_, before_.data()), 0);
    auto less = before_;
    less[0].effective &= ~(1U << CAP_DAC_OVERRIDE);
    EXPECT_EQ(::syscall(SYS_capset, &header_, less.data()), 0);
  }
  WithoutOverride(const WithoutOverride&) = delete;
  WithoutOverride& operator=(const WithoutOverride&) = delete;
  ~WithoutOverride() { (void)::syscall(SYS_capset, &header_, before_.data()); }

 private:
  __user_cap_header_struct header_{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  std::array<__user_cap_data_struct, 2> before_{};
};

TEST(SerialPort, CarriesEveryByteUnchangedBothWays) {
  const Pty pty;
  const auto port = openSerialPort(pty.path(), {});
  ASSERT_TRUE(port) << port.error().message;
  std::vector<std::uint8_t> all;
  for (int i = 0; i < 256; ++i) all.push_back(static_cast<std::uint8_t>(i));
  pty.send(all);
  EXPECT_EQ(readAll(port->get()), all);
  ASSERT_EQ(::write(port->get(), all.data(), all.size()), 256);
  EXPECT_EQ(pty.received(), all);
}

TEST(SerialPort, TakesAnyBaudRate) {
  for (const int baud : {50, 9600, 100000, 115200, 250000, 921600, 3000000}) {
    const Pty pty;
    const auto port = openSerialPort(pty.path(), {.baud = baud});
    ASSERT_TRUE(port) << port.error().message;
    termios2 settings{};
    ASSERT_EQ(::ioctl(port->get(), TCGETS2, &settings), 0);
    EXPECT_EQ(settings.c_ospeed, static_cast<speed_t>(baud));
    EXPECT_EQ(settings.c_ispeed, static_cast<speed_t>(baud));
  }
}

TEST(SerialPort, OpensTheFormatsOfRemoteReceivers) {
  for (const char* frame : {"8E1", "8E2"}) {
    const Pty pty;
    const auto port = openSerialPort(pty.path(), SerialFormat::make(100000, frame).value());
    ASSERT_TRUE(port) << port.error().message;
    pty.send({0x0F, 0x00, 0xFF});
    EXPECT_THAT(readAll(port->get()), ElementsAre(0x0F, 0x00, 0xFF));
  }
}

TEST(SerialPort, NothingToReadIsNotTheEnd) {
  const Pty pty;
  const auto port = openSerialPort(pty.path(), {});
  std::uint8_t byte = 0;
  EXPECT_EQ(::read(port->get(), &byte, 1), -1);
  EXPECT_EQ(errno, EAGAIN);
}

TEST(SerialPort, WhatCameBeforeItWasOpenedIsThrownAway) {
  const Pty pty;
  const UniqueFd before{::open(pty.path().c_str(), O_RDWR | O_NOCTTY)};
  pty.send({'o', 'l', 'd', '\n'});
  const auto port = openSerialPort(pty.path(), {});
  pty.send({'n', 'e', 'w'});
  EXPECT_THAT(readAll(port->get()), ElementsAre('n', 'e', 'w'));
}

TEST(SerialPort, UnpluggedItHangsUp) {
  Pty pty;
  const auto port = openSerialPort(pty.path(), {});
  pty.send({1, 2, 3});
  pty.unplug();
  pollfd wait{.fd = port->get(), .events = POLLIN, .revents = 0};
  ASSERT_EQ(::poll(&wait, 1, 10'000), 1);
  EXPECT_NE(wait.revents & POLLHUP, 0);
  std::uint8_t byte = 0;
  for (ssize_t n = 1; n > 0;) n = ::read(port->get(), &byte, 1);
  EXPECT_LE(::read(port->get(), &byte, 1), 0);
  EXPECT_NE(errno, EAGAIN);
}

TEST(SerialPort, IsOpenedByOneProgramOnly) {
  const Pty pty;
  const auto first = openSerialPort(pty.path(), {});
  ASSERT_TRUE(first);
  const auto second = openSerialPort(pty.path(), {});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, AllOf(HasSubstr(pty.path()), HasSubstr("fuser")));
}

TEST(SerialPort, AMissingOneIsAnErrorThatShowsWhatThereIs) {
  const auto port = openSerialPort("/dev/ttyUSB99", {});
  ASSERT_FALSE(port);
  EXPECT_THAT(port.error().message,
              AllOf(HasSubstr("/dev/ttyUSB99"), HasSubstr("No such file"), HasSubstr("/dev/serial/by-id")));
}

TEST(SerialPort, WhatIsNoPortIsRefused) {
  const auto port = openSerialPort("/dev/null", {});
  ASSERT_FALSE(port);
  EXPECT_THAT(port.error().message, HasSubstr("'/dev/null': it is no serial port"));
}

TEST(SerialPort, AnErrorOfRightsNamesTheGroup) {
  const Pty pty;
  ASSERT_EQ(::chmod(pty.path().c_str(), 0), 0);
  const WithoutOverride like_any_user;
  const auto port = openSerialPort(pty.path(), {});
  ASSERT_FALSE(port);
  EXPECT_THAT(port.error().message, AllOf(HasSubstr(pty.path()), HasSubstr("usermod -aG dialout")));
}

class SteadySerialName : public ::testing::Test {
 protected:
  SteadySerialName() { std::filesystem::create_directories(names_); }
  ~SteadySerialName() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("rc10-serial-names-" + std::to_string(::getpid()));
  std::filesystem::path names_ = folder_ / "by-id";
  Pty pty_;
};

TEST_F(SteadySerialName, LeadsToTheSameDevice) {
  std::filesystem::create_symlink("/dev/null", names_ / "usb-other");
  std::filesystem::create_symlink("nowhere", names_ / "usb-dangling");
  EXPECT_EQ(steadySerialName(pty_.path(), names_), "");
  std::filesystem::create_symlink(pty_.path(), names_ / "usb-imu");
  EXPECT_EQ(steadySerialName(pty_.path(), names_), (names_ / "usb-imu").string());
  EXPECT_EQ(steadySerialName(names_ / "usb-imu", names_), "") << "it is the steady name";
}

TEST_F(SteadySerialName, IsEmptyWhereThereIsNone) {
  EXPECT_EQ(steadySerialName("/dev/ttyUSB99", names_), "");
  EXPECT_EQ(steadySerialName(pty_.path(), folder_ / "missing"), "");
}

}  // namespace
}  // namespace rc10::test::serial_port_test
