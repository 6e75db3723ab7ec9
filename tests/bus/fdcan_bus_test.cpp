#include "bus/fdcan_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <array>

#include "bus/fdcan_bus_fixture.hpp"

namespace rc10::test::fdcan_bus_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// ---- registration ----

TEST_F(FdCanBusTest, HasTheNameAndTheDescriptorItWasGiven) {
  EXPECT_EQ(bus_->name(), "chassis");
  EXPECT_GE(bus_->descriptor(), 0);
  EXPECT_FALSE(bus_->fdFrames());
  EXPECT_TRUE(bus_->packers().empty());
}

TEST_F(FdCanBusTest, RefusesCollidingDevicesAndNamesTheBusBothDevicesAndTheId) {
  addDevice("wheel", {standardFilter(0x205)});
  FakeDevice yaw("yaw", {standardFilter(0x205)});
  const auto ok = bus_->registerMotor(yaw);
  ASSERT_FALSE(ok);
  EXPECT_THAT(ok.error().message, AllOf(HasSubstr("bus 'chassis'"), HasSubstr("'wheel'"), HasSubstr("'yaw'"),
                                        HasSubstr("standard id 0x205")));
}

TEST_F(FdCanBusTest, RefusesTwoPackersWithOneIdAndNamesBoth) {
  addPacker(0x200);
  FakePacker other("other", {0x200, false});
  const auto ok = bus_->registerMotor(other);
  ASSERT_FALSE(ok);
  EXPECT_THAT(ok.error().message, AllOf(HasSubstr("bus 'chassis'"), HasSubstr("'p512'"), HasSubstr("'other'"),
                                        HasSubstr("standard id 0x200")));
  FakePacker extended("extended", {0x200, true});
  EXPECT_TRUE(bus_->registerMotor(extended));
}

TEST_F(FdCanBusTest, RefusesAPackerThatIsAlreadyThere) {
  FakePacker& packer = addPacker(0x200);
  const auto ok = bus_->registerMotor(packer);
  ASSERT_FALSE(ok);
  EXPECT_THAT(ok.error().message, HasSubstr("'p512' is registered twice"));
  EXPECT_EQ(bus_->packers().size(), 1U);
}

TEST_F(FdCanBusTest, HoldsThirtyTwoPackersAndRefusesTheNext) {
  addPackers(32);
  FakePacker one_more("one_more", {0x700, false});
  const auto ok = bus_->registerMotor(one_more);
  ASSERT_FALSE(ok);
  EXPECT_THAT(ok.error().message, AllOf(HasSubstr("'one_more'"), HasSubstr("at most 32")));
}

TEST_F(FdCanBusTest, HoldsThirtyTwoDevicesAndRefusesTheNext) {
  for (std::uint32_t i = 0; i < 32; ++i) addDevice("m" + std::to_string(i), {standardFilter(0x200 + i)});
  FakeDevice one_more("one_more", {standardFilter(0x100)});
  const auto ok = bus_->registerMotor(one_more);
  ASSERT_FALSE(ok);
  EXPECT_THAT(ok.error().message, AllOf(HasSubstr("'one_more'"), HasSubstr("at most 32")));
}

// ---- receiving ----

TEST_F(FdCanBusTest, AFrameWithACommandIdOfOursIsASecondCommandersWherever) {
  addPacker(0x200);
  addPacker(0x1FF);
  CanFrame frame = classic({0x1FF, false});
  frame.sent_here = true;
  bus_->dispatch(frame);
  EXPECT_EQ(bus_->lastForeign().id, (CanId{0x1FF, false}));
  EXPECT_TRUE(bus_->lastForeign().sent_here);
  bus_->dispatch(classic({0x200, false}));
  EXPECT_EQ(bus_->lastForeign().id, (CanId{0x200, false}));
  EXPECT_FALSE(bus_->lastForeign().sent_here);
  EXPECT_EQ(counters().rx_foreign, 2U);
  EXPECT_EQ(counters().rx_unmatched, 2U);
}

TEST_F(FdCanBusTest, AFrameThatADeviceClaimsOrThatAsksForDataIsNot) {
  addPacker(0x200);
  addPacker(0x300);
  addDevice("answers_with_its_command_id", {standardFilter(0x300)});
  bus_->dispatch(classic({0x300, false}));
  CanFrame remote = classic({0x200, false});
  remote.type = FrameType::kRemote;
  bus_->dispatch(remote);
  bus_->dispatch(classic({0x200, true}));
  EXPECT_EQ(counters().rx_foreign, 0U);
}

TEST_F(FdCanBusTest, WhatIsHeldBackIsCountedAndNeverSent) {
  addPackers(3);
  bus_->packCommands(tick_);
  bus_->holdBack();
  EXPECT_EQ(counters().tx_held, 3U);
  bus_->flush();
  EXPECT_TRUE(idsOnWire().empty());
  EXPECT_EQ(counters().tx_dropped, 0U);
  EXPECT_EQ(sendTick().size(), 3U);
}

TEST_F(FdCanBusTest, GivesEachFrameToTheDeviceItBelongsTo) {
  FakeDevice& dji = addDevice("dji", {standardFilter(0x201)});
  FakeDevice& extended = addDevice("extended", {extendedFilter(0x201)});
  FakeDevice& strider = addDevice("strider", {robStrideFilter(5)});
  FakeDevice& damiao_1 = addDevice("damiao_1", {damiaoFilter(0x11, 1)});
  FakeDevice& damiao_2 = addDevice("damiao_2", {damiaoFilter(0x11, 2)});
  bus_->dispatch(classic({0x201, false}));
  bus_->dispatch(classic({0x201, true}));
  bus_->dispatch(classic({0x0280'05FD, true}));
  bus_->dispatch(classic({0x1500'05FD, true}));
  bus_->dispatch(classic({0x11, false}, {0x01}));
  bus_->dispatch(classic({0x11, false}, {0x12}));
  EXPECT_EQ(dji.received, 1);
  EXPECT_EQ(extended.received, 1);
  EXPECT_EQ(strider.received, 2);
  EXPECT_EQ(damiao_1.received, 1);
  EXPECT_EQ(damiao_2.received, 1);
  EXPECT_EQ(counters().rx_frames, 6U);
  EXPECT_EQ(counters().rx_unmatched, 0U);
}

TEST_F(FdCanBusTest, HandsOverTheFrameAsReceived) {
  FakeDevice& device = addDevice("dji", {standardFilter(0x201)});
  CanFrame frame = classic({0x201, false}, {1, 2, 3});
  frame.received = MonotonicTime{Duration{12345}};
  bus_->dispatch(frame);
  EXPECT_EQ(device.last.received, frame.received);
  EXPECT_EQ(device.last.data, frame.data);
}

TEST_F(FdCanBusTest, CountsFramesOfStrangersAndMalformedOnes) {
  FakeDevice& device = addDevice("dji", {standardFilter(0x201)});
  device.verdict = FrameVerdict::kMalformed;
  bus_->dispatch(classic({0x201, false}));
  bus_->dispatch(classic({0x300, false}));
  CanFrame remote = classic({0x201, false});
  remote.type = FrameType::kRemote;
  bus_->dispatch(remote);
  EXPECT_EQ(counters().rx_frames, 3U);
  EXPECT_EQ(counters().rx_malformed, 1U);
  EXPECT_EQ(counters().rx_unmatched, 2U);
  EXPECT_EQ(device.received, 1);
}

TEST_F(FdCanBusTest, ErrorFramesGoToTheHealthOfTheBusAndToNoDevice) {
  FakeDevice& device = addDevice("four", {standardFilter(CAN_ERR_BUSOFF)});
  CanFrame frame = classic({CAN_ERR_BUSOFF, false}, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.type = FrameType::kError;
  bus_->dispatch(frame);
  EXPECT_EQ(bus_->health().state(), BusState::kBusOff);
  EXPECT_EQ(bus_->health().errorFrames(), 1U);
  EXPECT_EQ(device.received, 0);
  EXPECT_EQ(counters().rx_frames, 0U);
}

TEST_F(FdCanBusTest, CountsTheBitsItReceives) {
  bus_->dispatch(classic({0x201, false}, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(counters().rx_bits, 111U);
  bus_->dispatch(makeFdFrame({0x1, true}, std::array<std::uint8_t, 8>{}, true));
  EXPECT_EQ(counters().rx_bits, 111U + 48U);
  EXPECT_EQ(counters().rx_data_bits, 145U - 48U);
}

// ---- sending ----

TEST_F(FdCanBusTest, SendsNothingBeforeFlush) {
  EXPECT_TRUE(bus_->sendFrame(classic({0x200, false}, {1})));
  EXPECT_TRUE(idsOnWire().empty());
  bus_->flush();
  EXPECT_THAT(idsOnWire(), ElementsAre(0x200));
  bus_->flush();
  EXPECT_TRUE(idsOnWire().empty());
  EXPECT_EQ(counters().tx_frames, 1U);
}

TEST_F(FdCanBusTest, SendsTheFramesOfAllPackersInTheirOrder) {
  addPackers(3, 2);
  EXPECT_THAT(sendTick(), ElementsAre(1, 1, 2, 2, 3, 3));
  EXPECT_THAT(sendTick(), ElementsAre(1, 1, 2, 2, 3, 3));
  EXPECT_EQ(counters().tx_frames, 12U);
  EXPECT_EQ(counters().tx_dropped, 0U);
}

TEST_F(FdCanBusTest, GivesAPackerRoomForFourFramesPerTick) {
  addPacker(7, 4);
  bus_->packCommands(tick_);
  bus_->flush();
  const auto frames = pair_.read();
  ASSERT_EQ(frames.size(), 4U);
  for (std::uint8_t i = 0; i < 4; ++i) EXPECT_EQ(frames[i].data[0], i);
}

TEST_F(FdCanBusTest, APackerThatClaimsMoreThanItsRoomSendsWhatItWrote) {
  addPacker(7, 100);
  EXPECT_THAT(sendTick(), ElementsAre(7, 7, 7, 7));
}

TEST_F(FdCanBusTest, APackerMayHaveNothingToSay) {
  addPacker(1, 0);
  addPacker(2, 1);
  EXPECT_THAT(sendTick(), ElementsAre(2));
}

TEST_F(FdCanBusTest, NothingOfAnEarlierPackerRemainsInTheRoomOfTheNext) {
  addPacker(1, 4);
  addPacker(2, 1);
  bus_->packCommands(tick_);
  bus_->packRest();
  bus_->flush();
  const auto frames = pair_.read();
  ASSERT_EQ(frames.size(), 7U);
  EXPECT_EQ(frames[4].data[0], 0);
  EXPECT_EQ(frames[5].data, frames[6].data);
}

TEST_F(FdCanBusTest, RestFramesComeFromEveryPacker) {
  addPackers(3, 2);
  bus_->packRest();
  bus_->flush();
  const auto frames = pair_.read();
  ASSERT_EQ(frames.size(), 3U);
  for (const CanFrame& frame : frames) EXPECT_EQ(frame.data[1], 0);
}

TEST_F(FdCanBusTest, CountsBitsAndTheWatchedIdOfWhatItSent) {
  bus_->watch(std::array{CanId{2, false}});
  addPackers(3);
  sendTick();
  sendTick();
  EXPECT_EQ(counters().tx_watched, 2U);
  EXPECT_EQ(counters().tx_bits, 6U * 111U);
  EXPECT_EQ(counters().tx_data_bits, 0U);
}

TEST_F(FdCanBusTest, AFrameThatAFullQueueRefusesIsWatchedToo) {
  bus_->watch(std::array{CanId{1, false}});
  addPackers(1);
  const auto send = [&] {
    bus_->packCommands(tick_);
    bus_->flush();
  };
  for (int i = 0; i < 100'000 && counters().tx_dropped == 0; ++i) send();
  const auto before = counters();
  ASSERT_EQ(before.tx_dropped, 1U);
  send();
  EXPECT_EQ(counters().tx_dropped, 2U);
  EXPECT_EQ(counters().tx_watched, before.tx_watched);
  EXPECT_EQ(counters().tx_watched_refused, 2U) << "else a bus that stays full is never stalled";
}

TEST_F(FdCanBusTest, WatchingAnExtendedIdIsNotWatchingTheStandardOne) {
  bus_->watch(std::array{CanId{2, true}});
  addPackers(3);
  sendTick();
  EXPECT_EQ(counters().tx_watched, 0U);
}

TEST_F(FdCanBusTest, RefusesFramesThatCannotExist) {
  EXPECT_FALSE(bus_->sendFrame(classic({0x800, false})));
  CanFrame frame = classic({0x200, false});
  frame.length = 9;
  EXPECT_FALSE(bus_->sendFrame(frame));
  frame = classic({0x20, false}, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.type = FrameType::kError;
  EXPECT_FALSE(bus_->sendFrame(frame));
  EXPECT_EQ(counters().tx_dropped, 3U);
  bus_->flush();
  EXPECT_TRUE(idsOnWire().empty());
}

TEST_F(FdCanBusTest, SendsRemoteFrames) {
  CanFrame frame = classic({0x200, false});
  frame.type = FrameType::kRemote;
  EXPECT_TRUE(bus_->sendFrame(frame));
  bus_->flush();
  ASSERT_EQ(pair_.read().at(0).type, FrameType::kRemote);
}

TEST_F(FdCanBusTest, RefusesAnFdFrameOnAClassicInterface) {
  const CanFrame frame = makeFdFrame({0x200, false}, std::array<std::uint8_t, 8>{}, true);
  EXPECT_FALSE(bus_->sendFrame(frame));
  EXPECT_EQ(counters().tx_dropped, 1U);
  addPacker(1).fd = true;
  addPacker(2);
  EXPECT_THAT(sendTick(), ElementsAre(2));
  EXPECT_EQ(counters().tx_dropped, 2U);
}

TEST_F(FdCanBusTest, MixesClassicAndFdFramesOnAnFdInterface) {
  useFd();
  addPacker(1);
  ASSERT_TRUE(bus_->sendFrame(makeFdFrame({0x9, true}, std::array<std::uint8_t, 19>{42}, true, 0x50)));
  bus_->packCommands(tick_);
  bus_->flush();
  const auto frames = pair_.read();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_TRUE(frames[0].fd);
  EXPECT_TRUE(frames[0].bit_rate_switch);
  EXPECT_EQ(frames[0].length, 20);
  EXPECT_EQ(frames[0].data[0], 42);
  EXPECT_EQ(frames[0].data[19], 0x50);
  EXPECT_FALSE(frames[1].fd);
  EXPECT_EQ(counters().tx_bits, 48U + 111U);
  EXPECT_EQ(counters().tx_data_bits, 246U - 48U);
}

TEST_F(FdCanBusTest, AnFdFrameOfAnInvalidLengthIsRefused) {
  useFd();
  CanFrame frame = makeFdFrame({0x200, false}, std::array<std::uint8_t, 12>{}, true);
  frame.length = 13;
  EXPECT_FALSE(bus_->sendFrame(frame));
}

}  // namespace
}  // namespace rc10::test::fdcan_bus_test
