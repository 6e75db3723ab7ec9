// A bus whose frames the kernel refuses.

#include "bus/fdcan_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

#include "bus/fdcan_bus_fixture.hpp"

namespace rc10::test::fdcan_bus_refusal_test {
namespace {

using testing::ElementsAre;

std::uint32_t idOf(const msghdr& message) {
  return static_cast<const can_frame*>(message.msg_iov->iov_base)->can_id;
}

TEST_F(FdCanBusTest, WhatTheKernelRefusesIsDroppedAndCounted) {
  shrinkSendBuffer();
  addPackers(30);
  const auto sent = sendTick();
  ASSERT_GT(sent.size(), 0U);
  ASSERT_LT(sent.size(), 30U);
  EXPECT_EQ(counters().tx_frames, sent.size());
  EXPECT_EQ(counters().tx_dropped, 30 - sent.size());
  EXPECT_EQ(counters().tx_bits, sent.size() * 111U);
}

TEST_F(FdCanBusTest, ARefusedCommandIsNeverSentLater) {
  shrinkSendBuffer();
  addPackers(30);
  const auto sent = sendTick();
  bus_->flush();
  EXPECT_TRUE(idsOnWire().empty());
  EXPECT_LT(sent.size(), 30U);
  bus_->packCommands(tick_);
  bus_->flush();
  const auto next = pair_.read();
  EXPECT_FALSE(next.empty());
  for (const CanFrame& frame : next) EXPECT_EQ(frame.data[1], 1) << "from the tick before";
}

TEST_F(FdCanBusTest, TheNextTickStartsAtThePackerThatWasRefused) {
  shrinkSendBuffer();
  addPackers(30);
  const auto first = sendTick();
  const auto second = sendTick();
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(second.front(), first.back() + 1);
}

TEST_F(FdCanBusTest, NobodyStarvesOnABusThatIsTooSmall) {
  shrinkSendBuffer();
  addPackers(30);
  std::set<std::uint32_t> heard;
  for (int tick = 0; tick < 30; ++tick) {
    for (const std::uint32_t id : sendTick()) heard.insert(id);
  }
  EXPECT_EQ(heard.size(), 30U);
}

TEST_F(FdCanBusTest, APackerThatIsRefusedInTheMiddleOfItsFramesComesFirstNextTime) {
  shrinkSendBuffer();
  addPackers(10, 4);
  const auto first = sendTick();
  ASSERT_LT(first.size(), 40U);
  const std::uint32_t interrupted = static_cast<std::uint32_t>(first.size() / 4) + 1;
  const auto second = sendTick();
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(second.front(), interrupted);
}

TEST_F(FdCanBusTest, FramesSentOnTheirOwnDoNotDisturbTheRotation) {
  shrinkSendBuffer();
  addPackers(3);
  for (int i = 0; i < 40; ++i) EXPECT_TRUE(bus_->sendFrame(classic({0x100, false})));
  EXPECT_THAT(sendTick(), testing::Each(0x100));
  EXPECT_EQ(sendTick().front(), 1U);
}

TEST_F(FdCanBusTest, AFullSocketDropsTheWholeTick) {
  shrinkSendBuffer();
  addPackers(30);
  bus_->packCommands(tick_);
  bus_->flush();
  const std::uint64_t before = counters().tx_frames;
  bus_->packCommands(tick_);
  bus_->flush();
  EXPECT_EQ(counters().tx_frames, before);
  EXPECT_EQ(counters().tx_dropped, 60 - before);
}

TEST_F(FdCanBusTest, ADeadSocketDropsEverythingAndHarmsNobody) {
  addPackers(5);
  pair_.far.reset();
  bus_->packCommands(tick_);
  bus_->flush();  // EPIPE, and no SIGPIPE
  EXPECT_EQ(counters().tx_frames, 0U);
  EXPECT_EQ(counters().tx_dropped, 5U);
}

TEST_F(FdCanBusTest, ATickHoldsSixtyFourFrames) {
  for (int i = 0; i < 64; ++i) EXPECT_TRUE(bus_->sendFrame(classic({0x100, false})));
  EXPECT_FALSE(bus_->sendFrame(classic({0x100, false})));
  bus_->flush();
  EXPECT_EQ(counters().tx_frames, 64U);
  EXPECT_EQ(counters().tx_dropped, 1U);
}

TEST_F(FdCanBusTest, APackerThatFindsNoRoomSendsNoneOfItsFramesAndComesFirstNextTime) {
  addPackers(21, 3);
  addPacker(22, 4);
  addPacker(23, 1);
  // 63 frames of the first 21; no room for 4, but for 1.
  auto sent = sendTick();
  EXPECT_EQ(sent.size(), 64U);
  EXPECT_EQ(sent.back(), 23U);
  EXPECT_EQ(counters().tx_dropped, 4U);
  sent = sendTick();
  EXPECT_EQ(sent.front(), 22U);
  // 4 + 1 + 19 * 3 frames leave no room for the three of 20 and 21.
  EXPECT_EQ(counters().tx_dropped, 4U + 6U);
  EXPECT_EQ(sendTick().front(), 20U);
}

TEST_F(FdCanBusTest, APackerIsToldThatAFrameOfItsWasNotSent) {
  const auto told = [this] {
    std::vector<int> unsent;
    for (auto& packer : packers_) unsent.push_back(std::exchange(packer.unsent, 0));
    return unsent;
  };
  addPackers(3);
  sendTick();
  EXPECT_THAT(told(), ElementsAre(0, 0, 0));
  frameCalls().refuse = [](const msghdr& message) { return idOf(message) == 2 ? ENOBUFS : 0; };
  sendTick();
  EXPECT_THAT(told(), ElementsAre(0, 1, 1)) << "refused by the kernel, or behind that one";
  frameCalls().refuse = nullptr;
  bus_->packCommands(tick_);
  bus_->holdBack();
  EXPECT_THAT(told(), ElementsAre(1, 1, 1)) << "held back";
  for (int i = 0; i < 62; ++i) EXPECT_TRUE(bus_->sendFrame(classic({0x100, false})));
  sendTick();
  EXPECT_THAT(told(), ElementsAre(1, 0, 0)) << "without room";
}

// ---- system calls, and errors that a socketpair does not have ----

TEST_F(FdCanBusTest, ATickIsOneSystemCall) {
  useFd();
  addPackers(20, 3);
  packers_[4].fd = true;
  for (int tick = 0; tick < 10; ++tick) sendTick();
  EXPECT_EQ(frameCalls().sendmmsg, 10U);
}

TEST_F(FdCanBusTest, ATickWithoutFramesIsNoSystemCall) {
  bus_->flush();
  EXPECT_EQ(frameCalls().sendmmsg, 0U);
}

TEST_F(FdCanBusTest, ARefusedTickIsOneSystemCallToo) {
  addPackers(5);
  for (const int error : {EAGAIN, ENOBUFS, ENETDOWN, ENXIO, ENODEV, EPERM, EBADF}) {
    SCOPED_TRACE(error);
    frameCalls() = {.refuse = [error](const msghdr&) { return error; }};
    const std::uint64_t dropped = counters().tx_dropped;
    EXPECT_TRUE(sendTick().empty());
    EXPECT_EQ(frameCalls().sendmmsg, 1U);
    EXPECT_EQ(bus_->sendError(), error);
    EXPECT_EQ(counters().tx_dropped, dropped + 5);
  }
  EXPECT_EQ(counters().tx_frames, 0U);
}

TEST_F(FdCanBusTest, TheRestOfAPartlyAcceptedTickIsNotTriedAgain) {
  addPackers(5);
  frameCalls().refuse = [](const msghdr& message) { return idOf(message) == 3 ? ENOBUFS : 0; };
  EXPECT_THAT(sendTick(), ElementsAre(1, 2));
  EXPECT_EQ(frameCalls().sendmmsg, 1U);
  EXPECT_EQ(bus_->sendError(), 0);
  EXPECT_EQ(counters().tx_dropped, 3U);
  frameCalls().refuse = nullptr;
  EXPECT_THAT(sendTick(), ElementsAre(3, 4, 5, 1, 2));
}

TEST_F(FdCanBusTest, FramesArriveAgainWhenTheInterfaceIsUpAgain) {
  addPackers(3);
  frameCalls().refuse = [](const msghdr&) { return ENETDOWN; };
  sendTick();
  EXPECT_EQ(bus_->sendError(), ENETDOWN);
  frameCalls().refuse = nullptr;
  EXPECT_THAT(sendTick(), ElementsAre(1, 2, 3));
  EXPECT_EQ(bus_->sendError(), 0);
}

// An FD frame on an interface that has become classic. Packing starts at what was refused: without care
// the one frame would silence the bus.
TEST_F(FdCanBusTest, AFrameThatNoOneWillAcceptDoesNotSilenceTheOthers) {
  addPackers(5);
  frameCalls().refuse = [](const msghdr& message) { return idOf(message) == 3 ? EINVAL : 0; };
  EXPECT_THAT(sendTick(), ElementsAre(1, 2));
  for (int tick = 0; tick < 5; ++tick) EXPECT_THAT(sendTick(), ElementsAre(4, 5, 1, 2));
  EXPECT_EQ(bus_->sendError(), 0);
  EXPECT_EQ(counters().tx_frames, 2U + 5U * 4U);
  EXPECT_EQ(counters().tx_dropped, 3U + 5U);
}

TEST_F(FdCanBusTest, FramesThatNoOneWillAcceptCostABoundedNumberOfSystemCalls) {
  addPackers(30);
  frameCalls().refuse = [](const msghdr&) { return EINVAL; };
  EXPECT_TRUE(sendTick().empty());
  EXPECT_EQ(frameCalls().sendmmsg, 5U);
  EXPECT_EQ(counters().tx_dropped, 30U);
}

TEST_F(FdCanBusTest, EveryByteThatReachesTheKernelIsInitialised) {
  useFd();
  addPackers(2);
  packers_[1].fd = true;
  sendTick();
  std::vector<std::size_t> sizes;
  frameCalls().refuse = [&sizes](const msghdr& message) {
    sizes.push_back(message.msg_iov->iov_len);
    const auto* const bytes = static_cast<const std::uint8_t*>(message.msg_iov->iov_base);
    // Number in the tick and tick index, then zero to the end.
    for (std::size_t i = 10; i < message.msg_iov->iov_len; ++i) EXPECT_EQ(bytes[i], 0) << i;
    return 0;
  };
  sendTick();
  EXPECT_THAT(sizes, ElementsAre(16, 72));
}

}  // namespace
}  // namespace rc10::test::fdcan_bus_refusal_test
