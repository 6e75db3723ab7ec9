// Real ports: pseudo terminals that are pulled and plugged in.
#include "daemon/devices/serial_reviver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "bus/serial_port.hpp"
#include "daemon/serial_rig.hpp"

namespace rc10::test::serial_reviver_test {
namespace {

using namespace std::chrono_literals;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SerialReviverTest : public ::testing::Test, protected SerialRig {
 protected:
  void isHeard(std::uint8_t byte) {
    protocol.bytes.clear();
    pty->send({byte});
    EXPECT_TRUE(pump([&] { return !protocol.bytes.empty(); }));
    EXPECT_THAT(protocol.bytes, ElementsAre(byte));
  }
};

TEST_F(SerialReviverTest, APortThatIsThereIsOpenedAtOnce) {
  plugIn();
  check();
  EXPECT_EQ(channel.state.load(), SerialState::kOpen);
  deliver(channel, device);
  EXPECT_EQ(device.state(), SerialState::kOpen);
  EXPECT_THAT(events(), ElementsAre(AllOf(HasSubstr(path), HasSubstr("is open, 115200 8N1"))));
  isHeard(7);
}

TEST_F(SerialReviverTest, AnAbsentPortIsTriedAgainWithBackOffAndToldOnce) {
  for (int i = 0; i < 10; ++i) check(1s);
  EXPECT_EQ(channel.state.load(), SerialState::kAbsent);
  EXPECT_THAT(events(), ElementsAre(AllOf(HasSubstr(path), HasSubstr("No such file"))));
  plugIn();
  check(1s);
  EXPECT_EQ(channel.state.load(), SerialState::kOpen);
  isHeard(1);
}

TEST_F(SerialReviverTest, ItIsNotTriedAtEveryLook) {
  check();
  plugIn();
  check(RetryPace::kFirstWait);
  EXPECT_EQ(channel.state.load(), SerialState::kAbsent);
  check(RetryPace::kFirstWait);
  EXPECT_EQ(channel.state.load(), SerialState::kOpen);
}

TEST_F(SerialReviverTest, APortThatWasPulledComesBackUnderItsNumber) {
  plugIn();
  check();
  const int number = channel.fd.get();
  for (std::uint8_t round = 1; round <= 3; ++round) {
    isHeard(round);
    pull();
    EXPECT_TRUE(pumpUntilGone());
    EXPECT_EQ(device.state(), SerialState::kAbsent);
    check(6s);
    plugIn();
    check(1s);
    EXPECT_EQ(channel.state.load(), SerialState::kOpen);
    EXPECT_EQ(channel.fd.get(), number);
  }
  isHeard(9);
  EXPECT_EQ(channel.hang_ups.load(), 3U);
  EXPECT_EQ(protocol.restarts, 4) << "no frame is made of bytes of two openings";
}

TEST_F(SerialReviverTest, ALossIsTold) {
  plugIn();
  check();
  (void)events();
  pull();
  ASSERT_TRUE(pumpUntilGone());
  check();
  EXPECT_THAT(events(), ElementsAre(HasSubstr("is gone")));
}

TEST_F(SerialReviverTest, ThePortIsLetGoSoThatTheKernelMayUseItsNameAgain) {
  plugIn();
  check();
  pull();
  ASSERT_TRUE(pumpUntilGone());
  check();
  struct stat held {};
  struct stat null {};
  ASSERT_EQ(::fstat(channel.fd.get(), &held), 0);
  ASSERT_EQ(::stat("/dev/null", &null), 0);
  EXPECT_EQ(held.st_rdev, null.st_rdev);
}

TEST_F(SerialReviverTest, PulledInTheMiddleOfAFrameNothingIsLostBeforeAndNothingComesAfter) {
  plugIn();
  check();
  pty->send({1, 2, 3});
  ASSERT_TRUE(pump([&] { return protocol.bytes.size() == 3; }));
  pull();
  ASSERT_TRUE(pumpUntilGone());
  check(6s);
  plugIn();
  check(1s);
  pty->send({4, 5});
  ASSERT_TRUE(pump([&] { return protocol.bytes.size() == 5; }));
  EXPECT_THAT(protocol.bytes, ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(protocol.restarts, 2);
}

TEST_F(SerialReviverTest, AHangUpIsNotWatchedAnyMore) {
  plugIn();
  check();
  pull();
  ASSERT_TRUE(pumpUntilGone());
  for (int i = 0; i < 20; ++i) rx->poll(Duration::zero());
  EXPECT_EQ(channel.hang_ups.load(), 1U) << "the RX thread would spin";
}

TEST_F(SerialReviverTest, APortThatComesAndGoesIsTriedEverLessOften) {
  plugIn();
  check();
  int opened = 1;
  for (int i = 0; i < 200; ++i) {  // 10 s
    if (channel.state.load() == SerialState::kOpen) {
      pull();
      ASSERT_TRUE(pumpUntilGone());
      plugIn();
    }
    check(50ms);
    if (channel.state.load() == SerialState::kOpen) ++opened;
  }
  EXPECT_GE(opened, 8);
  EXPECT_LE(opened, 15);
}

TEST_F(SerialReviverTest, APortOfSomeoneElseIsWaitedFor) {
  plugIn();
  {
    const auto other = openSerialPort(path, {});
    check();
    EXPECT_EQ(channel.state.load(), SerialState::kAbsent);
    EXPECT_THAT(events(), ElementsAre(HasSubstr("another program")));
  }
  check(1s);
  EXPECT_EQ(channel.state.load(), SerialState::kOpen);
}

TEST_F(SerialReviverTest, WithoutPortsThereIsNothingToDo) {
  const auto none = SerialChannels::create({}).value();
  SerialReviver idle{*none, watch(), exchange};
  idle.check(now);
  SerialWriter{*none}.flush();
  EXPECT_THAT(events(), IsEmpty());
}

}  // namespace
}  // namespace rc10::test::serial_reviver_test
