#include "daemon/devices/serial_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "daemon/serial_rig.hpp"

namespace rc10::test::serial_writer_test {
namespace {

using namespace std::chrono_literals;

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class SerialWriterTest : public ::testing::Test, protected SerialRig {
 protected:
  void open() {
    plugIn();
    check(1s);
    deliver(channel, device);
  }
  bool send(std::size_t count, std::uint8_t byte) {
    const std::vector<std::uint8_t> bytes(count, byte);
    return device.send(bytes);
  }
};

TEST_F(SerialWriterTest, WritesWhatTheSchedulerSends) {
  open();
  EXPECT_TRUE(send(2, 7));
  EXPECT_TRUE(send(1, 8));
  writer.flush();
  EXPECT_THAT(pty->received(), ElementsAre(7, 7, 8));
  EXPECT_EQ(device.counters().bytes_out, 3U);
}

TEST_F(SerialWriterTest, NothingIsSentToAnAbsentPort) {
  EXPECT_FALSE(send(5, 1));
  EXPECT_EQ(device.counters().refused_bytes, 5U);
}

TEST_F(SerialWriterTest, WhatAPulledPortDidNotTakeIsNotWrittenWhenItIsBack) {
  open();
  EXPECT_TRUE(send(10, 1));
  pull();
  ASSERT_TRUE(pumpUntilGone());
  writer.flush();
  EXPECT_EQ(channel.discarded_bytes.load(), 10U);
  check(6s);
  open();
  EXPECT_TRUE(send(1, 2));
  writer.flush();
  EXPECT_THAT(pty->received(), ElementsAre(2));
}

TEST_F(SerialWriterTest, APortThatIsNotYetKnownToBeGoneCostsOnlyItsBytes) {
  open();
  EXPECT_TRUE(send(10, 1));
  pull();
  writer.flush();
  EXPECT_EQ(channel.discarded_bytes.load(), 10U);
}

TEST_F(SerialWriterTest, ASlowPortTakesItAllInTheEndAndInOrder) {
  open();
  std::vector<std::uint8_t> sent;
  std::vector<std::uint8_t> got;
  // More than a pseudo terminal holds.
  for (std::uint8_t round = 0; round < 100; ++round) {
    if (send(1000, round)) sent.insert(sent.end(), 1000, round);
    writer.flush();
  }
  EXPECT_GT(device.counters().refused_bytes, 0U) << "the queue is bounded";
  for (int i = 0; i < 1000 && got.size() < sent.size(); ++i) {
    const auto more = pty->received();
    got.insert(got.end(), more.begin(), more.end());
    writer.serve(1ms);
  }
  EXPECT_EQ(got, sent);
  EXPECT_EQ(channel.discarded_bytes.load(), 0U);
}

TEST_F(SerialWriterTest, ServesAtOnceWhatComesMeanwhile) {
  open();
  std::thread scheduler([&] { EXPECT_TRUE(send(3, 9)); });
  std::vector<std::uint8_t> got;
  for (int i = 0; i < 1000 && got.size() < 3; ++i) {
    writer.serve(10ms);
    const auto more = pty->received();
    got.insert(got.end(), more.begin(), more.end());
  }
  scheduler.join();
  EXPECT_THAT(got, ElementsAre(9, 9, 9));
}

TEST_F(SerialWriterTest, APushWakesTheIoThread) {
  open();
  pollfd wait{.fd = channels->wake(), .events = POLLIN, .revents = 0};
  EXPECT_EQ(::poll(&wait, 1, 0), 0);
  EXPECT_TRUE(send(1, 1));
  EXPECT_EQ(::poll(&wait, 1, 0), 1);
  writer.flush();
  EXPECT_EQ(::poll(&wait, 1, 0), 0);
}

TEST_F(SerialWriterTest, ServesForATimeWithoutAnythingToDo) {
  writer.serve(1ms);
  EXPECT_EQ(channel.discarded_bytes.load(), 0U);
}

}  // namespace
}  // namespace rc10::test::serial_writer_test
