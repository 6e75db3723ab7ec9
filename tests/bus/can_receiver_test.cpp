#include "bus/can_receiver.hpp"

#include <gtest/gtest.h>
#include <time.h>

#include <array>
#include <chrono>
#include <cstring>

#include "bus/control_messages.hpp"
#include "bus/socket_pair.hpp"
#include "bus/wire_frame.hpp"
#include "support/frame_calls.hpp"

namespace rc10::test::can_receiver_test {
namespace {

using namespace std::chrono_literals;

Duration readClock(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
}

Duration realtimeOffset() { return readClock(CLOCK_REALTIME) - readClock(CLOCK_MONOTONIC); }
MonotonicTime monotonicNow() { return MonotonicTime{readClock(CLOCK_MONOTONIC)}; }

class CanReceiverTest : public testing::Test {
 protected:
  void SetUp() override { frameCalls() = {}; }
  void TearDown() override { frameCalls() = {}; }

  void enableStamps() {
    const int on = 1;
    ASSERT_EQ(::setsockopt(pair_.near.get(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)), 0);
  }

  Reception receive() { return receiver_.receive(wake_, out_); }

  /// The next wake-up reads the clock 10 s from now, and the one before did 10 s ago: only the stamp of a
  /// frame can lie between.
  void pauseAround(MonotonicTime before, MonotonicTime after) {
    wake_ = {.now = after + 10s,
             .previous = before - 10s,
             .realtime_offset = realtimeOffset(),
             .previous_offset = realtimeOffset()};
  }
  /// Stamped frames that come within such a pause. Returns when the last one was there.
  MonotonicTime writeInAPause(int frames) {
    enableStamps();
    const MonotonicTime before = monotonicNow();
    for (int i = 0; i < frames; ++i) pair_.write(numbered(1));
    const MonotonicTime written = monotonicNow();
    pauseAround(before, written);
    return written;
  }
  void wakeAgain() {
    wake_.previous = wake_.now;
    wake_.now += 1ms;
  }

  SocketPair pair_;
  CanReceiver receiver_{pair_.near.get()};
  std::array<CanFrame, CanReceiver::kBatch> out_{};
  WakeUp wake_{
      .now = MonotonicTime{10s}, .previous = MonotonicTime{9s}, .realtime_offset = 0s, .previous_offset = 0s};
};

TEST_F(CanReceiverTest, AnEmptySocketIsNoError) {
  const Reception reception = receive();
  EXPECT_EQ(reception.frame_count, 0U);
  EXPECT_EQ(reception.error, 0);
}

TEST_F(CanReceiverTest, ReceivesFramesInTheirOrderInOneCall) {
  for (std::uint8_t i = 0; i < 20; ++i) pair_.write(numbered(i));
  ASSERT_EQ(receive().frame_count, 20U);
  for (std::uint8_t i = 0; i < 20; ++i) EXPECT_EQ(out_[i].data[0], i);
}

TEST_F(CanReceiverTest, LeavesToTheNextCallWhatExceedsTheBatch) {
  for (std::uint8_t i = 0; i < 100; ++i) pair_.write(numbered(i));
  EXPECT_EQ(receive().frame_count, CanReceiver::kBatch);
  EXPECT_EQ(receive().frame_count, 100 - CanReceiver::kBatch);
  EXPECT_EQ(out_[0].data[0], CanReceiver::kBatch);
}

TEST_F(CanReceiverTest, WritesNoMoreThanThereIsRoomFor) {
  for (std::uint8_t i = 0; i < 5; ++i) pair_.write(numbered(i));
  EXPECT_EQ(receiver_.receive(wake_, std::span(out_).first(2)).frame_count, 2U);
  EXPECT_EQ(receiver_.receive(wake_, {}).frame_count, 0U);
  EXPECT_EQ(receive().frame_count, 3U);
  EXPECT_EQ(out_[0].data[0], 2);
}

TEST_F(CanReceiverTest, TellsClassicFromFdByTheSize) {
  pair_.write(numbered(1));
  pair_.write(makeFdFrame({0x8001, true}, std::array<std::uint8_t, 20>{7}, true));
  pair_.write(numbered(2));
  ASSERT_EQ(receive().frame_count, 3U);
  EXPECT_FALSE(out_[0].fd);
  EXPECT_TRUE(out_[1].fd);
  EXPECT_TRUE(out_[1].bit_rate_switch);
  EXPECT_EQ(out_[1].id, (CanId{0x8001, true}));
  EXPECT_EQ(out_[1].length, 20);
  EXPECT_FALSE(out_[2].fd);
  EXPECT_EQ(out_[2].length, 8);
}

TEST_F(CanReceiverTest, PassesOnErrorAndRemoteFramesAsWhatTheyAre) {
  CanFrame error = numbered(0);
  error.type = FrameType::kError;
  error.id = {CAN_ERR_FLAG >> 24U, false};
  pair_.write(error);
  CanFrame remote = numbered(0);
  remote.type = FrameType::kRemote;
  pair_.write(remote);
  ASSERT_EQ(receive().frame_count, 2U);
  EXPECT_EQ(out_[0].type, FrameType::kError);
  EXPECT_EQ(out_[1].type, FrameType::kRemote);
}

TEST_F(CanReceiverTest, CountsAndSkipsMessagesThatAreNoFrames) {
  const std::array<std::uint8_t, 200> bytes{};
  pair_.write(numbered(1));
  for (const std::size_t size : {1U, 15U, 17U, 71U, 73U, 200U}) pair_.write(bytes.data(), size);
  can_frame too_long{};
  too_long.len = 9;
  pair_.write(&too_long, sizeof(too_long));
  pair_.write(numbered(2));
  const Reception reception = receive();
  EXPECT_EQ(reception.malformed_count, 7U);
  ASSERT_EQ(reception.frame_count, 2U);
  EXPECT_EQ(out_[0].data[0], 1);
  EXPECT_EQ(out_[1].data[0], 2);
  EXPECT_EQ(reception.error, 0);
}

TEST_F(CanReceiverTest, TheEndOfASimulatedBusIsAnInterfaceThatIsGone) {
  pair_.write(numbered(1));
  pair_.far.reset();
  const Reception reception = receive();
  EXPECT_EQ(reception.frame_count, 1U);
  EXPECT_EQ(reception.malformed_count, 0U);
  EXPECT_EQ(reception.error, ENODEV);
  EXPECT_EQ(receive().error, ENODEV);
}

TEST_F(CanReceiverTest, ReportsAnErrorOfTheSocket) {
  CanReceiver receiver(-1);
  EXPECT_EQ(receiver.receive(wake_, out_).error, EBADF);
}

TEST_F(CanReceiverTest, AReceptionIsOneSystemCall) {
  for (std::uint8_t i = 0; i < 30; ++i) pair_.write(numbered(i));
  EXPECT_EQ(receive().frame_count, 30U);
  EXPECT_EQ(frameCalls().recvmmsg, 1U);
}

TEST_F(CanReceiverTest, MarksFramesThatWereSentOnThisComputer) {
  for (std::uint8_t i = 0; i < 5; ++i) pair_.write(numbered(i));
  int message_index = 0;
  frameCalls().received = [&message_index](msghdr& message) {
    // Another socket's, and the receiving socket's own: the kernel sets both flags on the latter.
    if (message_index == 1) message.msg_flags |= MSG_DONTROUTE;
    if (message_index == 3) message.msg_flags |= MSG_DONTROUTE | MSG_CONFIRM;
    ++message_index;
  };
  ASSERT_EQ(receive().frame_count, 5U);
  std::vector<int> marked;
  for (int i = 0; i < 5; ++i) {
    if (out_[static_cast<std::size_t>(i)].sent_here) marked.push_back(i);
  }
  EXPECT_EQ(marked, (std::vector<int>{1, 3}));
}

TEST_F(CanReceiverTest, AFrameWithoutStampWasReceivedNow) {
  pair_.write(numbered(1));
  ASSERT_EQ(receive().frame_count, 1U);
  EXPECT_EQ(out_[0].received, wake_.now);
}

TEST_F(CanReceiverTest, AStampIsTheTimeOfReceptionOnTheMonotonicClock) {
  enableStamps();
  const MonotonicTime before = monotonicNow();
  pair_.write(numbered(1));
  pair_.write(numbered(2));
  const MonotonicTime after = monotonicNow();
  pauseAround(before, after);
  ASSERT_EQ(receive().frame_count, 2U);
  constexpr Duration kOffsetNoise = 5ms;  // two clocks are not read at the same instant
  EXPECT_GE(out_[0].received, before - kOffsetNoise);
  EXPECT_LE(out_[1].received, after + kOffsetNoise);
  EXPECT_LE(out_[0].received, out_[1].received);
}

// After a pause there may be more than one batch; the second was there already when the first was read.
TEST_F(CanReceiverTest, WhatABatchLeftBehindKeepsItsStamp) {
  const MonotonicTime written = writeInAPause(2 * static_cast<int>(CanReceiver::kBatch));
  ASSERT_EQ(receive().frame_count, CanReceiver::kBatch);
  wakeAgain();
  ASSERT_EQ(receive().frame_count, CanReceiver::kBatch);
  EXPECT_LE(out_[0].received, written + 5ms);
  // All of it was read: what comes now came later.
  wakeAgain();
  EXPECT_EQ(receive().frame_count, 0U);
  pair_.write(numbered(2));
  wakeAgain();
  ASSERT_EQ(receive().frame_count, 1U);
  EXPECT_EQ(out_[0].received, wake_.previous);
}

TEST_F(CanReceiverTest, AFrameWithItsOwnStampKeepsIt) {
  StampedFrame message{};
  CanFrame frame = numbered(1);
  frame.received = MonotonicTime{9500ms};
  const auto classic = encodeFrame(frame, message);
  ASSERT_EQ(::send(pair_.far.get(), &message, classic, 0), 24);
  frame = makeFdFrame({0x8001, true}, std::array<std::uint8_t, 64>{7}, true);
  frame.received = MonotonicTime{9600ms};
  const auto fd = encodeFrame(frame, message);
  ASSERT_EQ(::send(pair_.far.get(), &message, fd, 0), 80);
  frame.received = MonotonicTime{11s};
  ASSERT_EQ(::send(pair_.far.get(), &message, encodeFrame(frame, message), 0), 80);
  ASSERT_EQ(receive().frame_count, 3U);
  EXPECT_EQ(out_[0].received, MonotonicTime{9500ms});
  EXPECT_EQ(out_[0].data[0], 1);
  EXPECT_EQ(out_[1].received, MonotonicTime{9600ms});
  EXPECT_EQ(out_[1].length, 64);
  EXPECT_EQ(out_[2].received, wake_.now);
}

TEST_F(CanReceiverTest, AStepOfTheWallClockMakesNoFrameLookFresh) {
  enableStamps();
  pair_.write(numbered(1));
  const MonotonicTime now = monotonicNow();
  wake_ = {.now = now,
           .previous = now - 1ms,
           .realtime_offset = realtimeOffset() + 3600s,
           .previous_offset = realtimeOffset()};
  ASSERT_EQ(receive().frame_count, 1U);
  EXPECT_EQ(out_[0].received, wake_.previous);
}

TEST_F(CanReceiverTest, StampsKeepComingAfterShortControlData) {
  // The kernel shortens msg_controllen at every message; it has to be restored.
  pair_.write(numbered(1));
  EXPECT_EQ(receive().frame_count, 1U);
  enableStamps();
  pair_.write(numbered(2));
  pauseAround(monotonicNow(), monotonicNow());
  ASSERT_EQ(receive().frame_count, 1U);
  EXPECT_LT(out_[0].received, wake_.now - 1s);
  EXPECT_GT(out_[0].received, wake_.previous + 1s);
}

TEST_F(CanReceiverTest, ASocketThatCountsDropsReportsNoneAtFirst) {
  const int on = 1;
  ASSERT_EQ(::setsockopt(pair_.near.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on)), 0);
  pair_.write(numbered(1));
  EXPECT_EQ(receive().kernel_dropped, 0U);
}

TEST_F(CanReceiverTest, TellsOnceOfFramesThatTheKernelDropped) {
  const auto told = [&](std::uint32_t count) {
    frameCalls().received = [count](msghdr& message) { reportDropped(message, count); };
    pair_.write(numbered(1));
    return receive().kernel_dropped;
  };
  EXPECT_EQ(told(17), 17U);
  EXPECT_EQ(receive().kernel_dropped, 0U) << "nothing received";
  EXPECT_EQ(told(17), 0U);
  EXPECT_EQ(told(2'000'000'017), 2'000'000'000U);
  EXPECT_EQ(told(4'000'000'017), 2'000'000'000U);
  EXPECT_EQ(told(UINT32_MAX - 2), UINT32_MAX - 2 - 4'000'000'017);
  EXPECT_EQ(told(5), 8U) << "the kernel's count goes on after 2^32";
  EXPECT_EQ(told(UINT32_MAX), UINT32_MAX) << "far behind: a new socket";
}

TEST_F(CanReceiverTest, ASocketThatWasOpenedAnewBeginsItsDropsAnew) {
  frameCalls().received = [](msghdr& message) { reportDropped(message, 5); };
  pair_.write(numbered(1));
  EXPECT_EQ(receive().kernel_dropped, 5U);
  frameCalls().received = nullptr;
  pair_.write(numbered(2));
  EXPECT_EQ(receive().kernel_dropped, 0U) << "it has dropped none yet";
  frameCalls().received = [](msghdr& message) { reportDropped(message, 100); };
  pair_.write(numbered(3));
  EXPECT_EQ(receive().kernel_dropped, 100U);
}

// The kernel ends a batch at an error, tells it in the next call, and has kept the frames behind it.
TEST_F(CanReceiverTest, FramesBehindAnErrorKeepTheirStamps) {
  const MonotonicTime written = writeInAPause(8);
  frameCalls().interrupted = {3, ENETDOWN};
  ASSERT_EQ(receive().frame_count, 3U);
  wakeAgain();
  EXPECT_EQ(receive().error, ENETDOWN);
  wakeAgain();
  ASSERT_EQ(receive().frame_count, 5U);
  EXPECT_LE(out_[4].received, written + 5ms);
}

TEST_F(CanReceiverTest, AnErrorBeforeTheFirstFramesTakesNoAgeFromThem) {
  const MonotonicTime written = writeInAPause(2);
  frameCalls().interrupted = {0, ENETDOWN};
  EXPECT_EQ(receive().error, ENETDOWN);
  wakeAgain();
  ASSERT_EQ(receive().frame_count, 2U);
  EXPECT_LE(out_[1].received, written + 5ms);
}

TEST_F(CanReceiverTest, AnErrorLongAfterTheLastFramesMakesNoFrameOlder) {
  enableStamps();
  pair_.write(numbered(1));
  wake_ = {.now = monotonicNow(),
           .previous = monotonicNow() - 1h,
           .realtime_offset = realtimeOffset(),
           .previous_offset = realtimeOffset()};
  ASSERT_EQ(receive().frame_count, 1U);
  EXPECT_EQ(receive().frame_count, 0U) << "empty";
  wake_ = {.now = monotonicNow() + 1ms,
           .previous = monotonicNow(),
           .realtime_offset = realtimeOffset() + 3600s,  // a step of the clock
           .previous_offset = realtimeOffset() + 3600s};
  frameCalls().interrupted = {0, ENETDOWN};
  EXPECT_EQ(receive().error, ENETDOWN);
  pair_.write(numbered(2));
  ASSERT_EQ(receive().frame_count, 1U);
  EXPECT_GE(out_[0].received, wake_.previous);
}

TEST_F(CanReceiverTest, CanBeMoved) {
  CanReceiver moved = std::move(receiver_);
  pair_.write(numbered(9));
  ASSERT_EQ(moved.receive(wake_, out_).frame_count, 1U);
  EXPECT_EQ(out_[0].data[0], 9);
}

}  // namespace
}  // namespace rc10::test::can_receiver_test
