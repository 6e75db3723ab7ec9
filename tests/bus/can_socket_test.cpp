#include "bus/can_socket.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <linux/can.h>
#include <sys/socket.h>
#include <array>

#include "bus/fdcan_bus.hpp"
#include "bus/socket_pair.hpp"

namespace rc10::test::can_socket_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Messages where there is no interface; tests/kernel has real ones.
bool kernelHasCan() { return UniqueFd{::socket(PF_CAN, SOCK_RAW, CAN_RAW)} || errno != EAFNOSUPPORT; }

auto expectedComplaint() {
  const char* const what =
      kernelHasCan() ? "ip link add dev nocan9 type vcan" : "this kernel has no SocketCAN";
  return AllOf(HasSubstr("CAN interface 'nocan9'"), HasSubstr(what));
}

TEST(CanSocket, SaysWhyAnInterfaceCannotBeOpenedAndWhatToDo) {
  const auto socket = openCanSocket("nocan9", {});
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().message, expectedComplaint());
}

TEST(CanSocket, SaysTheSameOfTheEchoSocket) {
  const auto socket = openEchoSocket("nocan9", std::array{CanId{0x200, false}});
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().message, expectedComplaint());
}

TEST(CanSocket, RecommendsTheSimulatorWhereTheKernelHasNoCan) {
  if (kernelHasCan()) return;  // then there is nothing to recommend
  EXPECT_THAT(openCanSocket("can0", {}).error().message, HasSubstr("type: sim"));
}

TEST(CanSocket, RefusesANameThatIsTooLongOrEmpty) {
  EXPECT_THAT(openCanSocket("a_name_of_16_chr", {}).error().message, HasSubstr("1 to 15 characters"));
  EXPECT_THAT(openCanSocket("", {}).error().message, HasSubstr("1 to 15 characters"));
}

TEST(CanSocket, ABusThatCannotBeOpenedIsNamed) {
  const auto bus = fdCANbus::open("chassis", "nocan9", {});
  ASSERT_FALSE(bus);
  EXPECT_THAT(bus.error().message, AllOf(HasSubstr("bus 'chassis'"), expectedComplaint()));
}

TEST(CanSocket, TheSendBufferHoldsBetweenOneAndTwoTicksOfFrames) {
  // A socketpair charges a frame in flight as CAN_RAW does. Below 8 the kernel's own minimum counts.
  for (const int frames_per_tick : {8, 12, 20, 64}) {
    SCOPED_TRACE(frames_per_tick);
    const SocketPair pair;
    const int request = sendBufferRequest(frames_per_tick);
    ASSERT_EQ(::setsockopt(pair.near.get(), SOL_SOCKET, SO_SNDBUF, &request, sizeof(request)), 0);
    const can_frame frame{};
    int in_flight = 0;
    while (::send(pair.near.get(), &frame, sizeof(frame), MSG_DONTWAIT) > 0) ++in_flight;
    EXPECT_GE(in_flight, frames_per_tick);
    EXPECT_LE(in_flight, 2 * frames_per_tick);
  }
}

TEST(CanSocket, TheSendBufferIsBoundedForAbsurdFrameCounts) {
  EXPECT_EQ(sendBufferRequest(0), sendBufferRequest(1));
  EXPECT_EQ(sendBufferRequest(-5), sendBufferRequest(1));
  EXPECT_EQ(sendBufferRequest(1'000'000'000), sendBufferRequest(256));
}

}  // namespace
}  // namespace rc10::test::can_socket_test
