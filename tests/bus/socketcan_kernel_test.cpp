// The sockets of src/bus on a kernel that has CAN. The suite exists only where vcan0 does and the tests
// may create interfaces: in the guest of tests/kernel, by `bus_test --gtest_filter='*SocketCan*'`.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "bus/can_receiver.hpp"
#include "bus/can_socket.hpp"
#include "bus/echo_counter.hpp"
#include "bus/fake_devices.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/wire_frame.hpp"

namespace rc10::test::socketcan_kernel_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

CanFrame numbered(CanId id, std::uint8_t number) {
  return makeClassicFrame(id, std::array<std::uint8_t, 8>{number});
}

void ip(const std::string& arguments) {
  ASSERT_EQ(std::system(("ip " + arguments).c_str()), 0) << "ip " << arguments;
}

Duration readClock(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
}

/// Two seconds around now, so that only a stamp can lie between two readings of the clock.
WakeUp wideWakeUp() {
  const Duration now = readClock(CLOCK_MONOTONIC);
  const Duration offset = readClock(CLOCK_REALTIME) - now;
  return {MonotonicTime{now + 1s}, MonotonicTime{now - 1s}, offset, offset};
}

struct Received {
  std::vector<CanFrame> frames;
  Reception reception;
};

/// Frames of one wake-up of the RX thread.
Received receiveFrom(CanReceiver& receiver, int fd) {
  pollfd waiting{fd, POLLIN, 0};
  ::poll(&waiting, 1, 100);
  std::array<CanFrame, CanReceiver::kBatch> out{};
  Received received;
  received.reception = receiver.receive(wideWakeUp(), out);
  received.frames.assign(out.begin(), out.begin() + received.reception.frame_count);
  return received;
}

/// Waits for the first. A virtual interface hands all of them over as they are sent.
std::size_t echoesOf(int fd) {
  pollfd waiting{fd, POLLIN, 0};
  ::poll(&waiting, 1, 100);
  return EchoCounter{fd}.take().confirmed;
}

class SocketCanTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    ip("link add dev rc10t0 type vcan");
    ip("link set rc10t0 mtu 72 up");
    bus_ = open();
    stranger_ = openStranger();
  }
  void TearDown() override {
    if (::if_nametoindex("rc10t0") != 0) ip("link del rc10t0");
  }

  static std::unique_ptr<fdCANbus> open() {
    auto bus = fdCANbus::open("bus", "rc10t0", {.frames_per_tick = 8});
    EXPECT_TRUE(bus) << bus.error().message;
    return bus ? std::move(*bus) : nullptr;
  }

  static CanSocket openStranger() {
    auto socket = openCanSocket("rc10t0", {});
    EXPECT_TRUE(socket) << socket.error().message;
    return socket ? std::move(*socket) : CanSocket{};
  }

  // Another program on this computer.
  void sendFromStranger(const CanFrame& frame) const {
    canfd_frame wire{};
    const std::size_t size = encodeFrame(frame, wire);
    ASSERT_EQ(::send(stranger_.fd.get(), &wire, size, 0), static_cast<ssize_t>(size));
  }

  void sendError(std::uint32_t classes, std::uint8_t crtl, std::uint8_t tec) const {
    CanFrame frame = makeClassicFrame({}, std::array<std::uint8_t, 8>{0, crtl, 0, 0, 0, 0, tec, 0});
    frame.type = FrameType::kError;
    frame.id = {classes, false};
    sendFromStranger(frame);
  }

  void sendFromBus(const CanFrame& frame) {
    EXPECT_TRUE(bus_->sendFrame(frame));
    bus_->flush();
  }

  Received receive() {
    CanReceiver receiver(bus_->descriptor());
    return receiveFrom(receiver, bus_->descriptor());
  }

  std::unique_ptr<fdCANbus> bus_;
  CanSocket stranger_;
};

TEST_P(SocketCanTest, SendsAndReceivesClassicAndFdFrames) {
  EXPECT_TRUE(bus_->fdFrames());
  sendFromBus(numbered({0x201, false}, 1));
  sendFromBus(makeFdFrame({0x8001, true}, std::array<std::uint8_t, 20>{2}, true));
  CanReceiver receiver(stranger_.fd.get());
  const auto [frames, reception] = receiveFrom(receiver, stranger_.fd.get());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_FALSE(frames[0].fd);
  EXPECT_EQ(frames[1].id, (CanId{0x8001, true}));
  EXPECT_TRUE(frames[1].fd);
  EXPECT_TRUE(frames[1].bit_rate_switch);
  EXPECT_EQ(frames[1].length, 20);
  EXPECT_EQ(bus_->counters().tx_frames, 2U);
}

TEST_P(SocketCanTest, StampsFramesOnTheMonotonicClock) {
  const MonotonicTime before{readClock(CLOCK_MONOTONIC)};
  sendFromStranger(numbered({0x201, false}, 1));
  const auto [frames, reception] = receive();
  const MonotonicTime after{readClock(CLOCK_MONOTONIC)};
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_GE(frames[0].received, before - 5ms);  // noise of reading two clocks
  EXPECT_LE(frames[0].received, after + 5ms);
}

TEST_P(SocketCanTest, DoesNotReceiveItsOwnFrames) {
  sendFromBus(numbered({0x200, false}, 1));
  sendFromStranger(numbered({0x201, false}, 2));
  const auto [frames, reception] = receive();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id.value, 0x201U);
}

TEST_P(SocketCanTest, TheEchoSocketSeesTheWatchedCommandOnceSent) {
  const auto echo = openEchoSocket("rc10t0", std::array{CanId{0x200, false}});
  ASSERT_TRUE(echo) << echo.error().message;
  sendFromBus(numbered({0x1FF, false}, 1));
  sendFromBus(numbered({0x200, true}, 2));
  sendFromBus(numbered({0x200, false}, 3));
  EXPECT_EQ(echoesOf(echo->get()), 1U);
}

TEST_P(SocketCanTest, TheEchoOfAnExtendedFdFrameIsSeenToo) {
  const auto echo = openEchoSocket("rc10t0", std::array{CanId{0x8001, true}});
  ASSERT_TRUE(echo);
  sendFromBus(makeFdFrame({0x8001, true}, std::array<std::uint8_t, 12>{4}, true));
  EXPECT_EQ(echoesOf(echo->get()), 1U);
}

TEST_P(SocketCanTest, AnotherProgramThatCommandsIsNoticed) {
  sendFromStranger(numbered({0x200, false}, 1));
  const auto [frames, reception] = receive();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].sent_here);
}

TEST_P(SocketCanTest, ReceivesStateChangesAndNotTheErrorsOfSingleFrames) {
  sendError(CAN_ERR_PROT | CAN_ERR_BUSERROR | 0x200U, 0, 40);
  sendError(CAN_ERR_ACK | CAN_ERR_LOSTARB, 0, 0);
  sendError(CAN_ERR_CRTL | 0x200U, CAN_ERR_CRTL_TX_PASSIVE, 136);
  sendError(CAN_ERR_BUSOFF, 0, 0);
  sendError(CAN_ERR_RESTARTED, 0, 0);
  const auto [frames, reception] = receive();
  ASSERT_EQ(frames.size(), 3U);
  bus_->dispatch(frames[0]);
  EXPECT_EQ(bus_->health().state(), BusState::kPassive);
  EXPECT_EQ(bus_->health().transmitErrors(), 136);
  bus_->dispatch(frames[1]);
  EXPECT_EQ(bus_->health().state(), BusState::kBusOff);
  bus_->dispatch(frames[2]);
  EXPECT_EQ(bus_->health().state(), BusState::kActive);
}

TEST_P(SocketCanTest, AnInterfaceWithoutFdIsRecognised) {
  ip("link set rc10t0 down");
  ip("link set rc10t0 mtu 16 up");
  bus_ = open();
  EXPECT_FALSE(bus_->fdFrames());
  EXPECT_FALSE(bus_->sendFrame(makeFdFrame({1, false}, std::array<std::uint8_t, 8>{}, true)));
}

TEST_P(SocketCanTest, FdFramesDoNotSilenceAnInterfaceThatHasBecomeClassic) {
  ip("link set rc10t0 down");
  ip("link set rc10t0 mtu 16 up");
  (void)receive();  // takes the error that going down has left
  FakePacker fd("fd", {1, false});
  FakePacker classic("classic", {2, false});
  fd.fd = true;
  ASSERT_TRUE(bus_->registerMotor(fd));
  ASSERT_TRUE(bus_->registerMotor(classic));
  for (int tick = 0; tick < 3; ++tick) {
    bus_->packCommands({});
    bus_->flush();
  }
  EXPECT_EQ(bus_->counters().tx_frames, 3U);
  EXPECT_EQ(bus_->counters().tx_dropped, 3U);
}

TEST_P(SocketCanTest, GoingDownIsReportedOnceAndTheSocketSurvivesIt) {
  ip("link set rc10t0 down");
  EXPECT_EQ(receive().reception.error, ENETDOWN);
  sendFromBus(numbered({0x200, false}, 1));
  EXPECT_EQ(bus_->counters().tx_dropped, 1U);
  EXPECT_EQ(bus_->sendError(), ENETDOWN);
  ip("link set rc10t0 up");
  CanReceiver receiver(stranger_.fd.get());
  EXPECT_EQ(receiveFrom(receiver, stranger_.fd.get()).reception.error, ENETDOWN);
  sendFromBus(numbered({0x200, false}, 2));
  const auto [frames, reception] = receiveFrom(receiver, stranger_.fd.get());
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].data[0], 2);
}

TEST_P(SocketCanTest, AnInterfaceThatIsDownCanBeOpened) {
  ip("link set rc10t0 down");
  bus_ = open();
  ASSERT_NE(bus_, nullptr);
  EXPECT_EQ(receive().reception.error, ENETDOWN);
  ip("link set rc10t0 up");
  sendFromBus(numbered({0x200, false}, 1));
  EXPECT_EQ(bus_->counters().tx_frames, 1U);
}

TEST_P(SocketCanTest, AnInterfaceThatVanishesIsReported) {
  ip("link del rc10t0");
  // Down comes before gone, and both are the socket's one pending error: the later one is kept.
  EXPECT_EQ(receive().reception.error, ENODEV);
  sendFromBus(numbered({0x200, false}, 1));
  EXPECT_EQ(bus_->counters().tx_dropped, 1U);
  EXPECT_EQ(bus_->sendError(), ENXIO);
}

TEST_P(SocketCanTest, ASendThatTakesTheNoticeOfGoingDownReportsItItself) {
  ip("link set rc10t0 down");
  sendFromBus(numbered({0x200, false}, 1));
  EXPECT_EQ(bus_->sendError(), ENETDOWN);
  EXPECT_EQ(receive().reception.error, 0);
}

TEST_P(SocketCanTest, FramesThatTheKernelDropsAreCounted) {
  const int minimum = 1;
  ASSERT_EQ(::setsockopt(bus_->descriptor(), SOL_SOCKET, SO_RCVBUF, &minimum, sizeof(minimum)), 0);
  for (std::uint8_t i = 0; i < 50; ++i) sendFromStranger(numbered({0x201, false}, i));
  CanReceiver receiver(bus_->descriptor());
  const auto first = receiveFrom(receiver, bus_->descriptor());
  EXPECT_LT(first.frames.size(), 50U);
  // The count travels with a frame that comes after the loss.
  sendFromStranger(numbered({0x201, false}, 99));
  const auto second = receiveFrom(receiver, bus_->descriptor());
  EXPECT_EQ(second.reception.kernel_dropped, 50 - first.frames.size());
}

TEST_P(SocketCanTest, BuffersHaveTheSizesAskedFor) {
  EXPECT_EQ(stranger_.send_buffer_bytes, 2 * sendBufferRequest(8));
  int bytes = 0;
  socklen_t size = sizeof(bytes);
  ASSERT_EQ(::getsockopt(bus_->descriptor(), SOL_SOCKET, SO_RCVBUF, &bytes, &size), 0);
  EXPECT_GE(bytes, 512 * 1024);
}

TEST_P(SocketCanTest, SaysThatAnInterfaceIsMissingOrNoCan) {
  EXPECT_THAT(openCanSocket("nocan9", {}).error().message,
              HasSubstr("`ip link add dev nocan9 type vcan && ip link set up nocan9`"));
  EXPECT_THAT(openCanSocket("lo", {}).error().message, HasSubstr("'lo' is not a CAN interface"));
}

std::vector<const char*> kernelsWithCan() {
  // Elsewhere shards of the program would make and remove the same interfaces side by side.
  const char* guest = std::getenv("RC10_GUEST");
  if (guest != nullptr && std::string_view{guest} == "kernel") return {"vcan"};
  return {};
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SocketCanTest);
INSTANTIATE_TEST_SUITE_P(Kernel, SocketCanTest, testing::ValuesIn(kernelsWithCan()));

}  // namespace
}  // namespace rc10::test::socketcan_kernel_test
