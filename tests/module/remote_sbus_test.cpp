// A remote whose receiver tells that it has lost its transmitter.
#include <gmock/gmock.h>

#include "module/sbus_protocol.hpp"
#include "remote_bench.hpp"

namespace rc10::test::remote_sbus_test {
namespace {

using ::testing::IsEmpty;

class SbusRemote : public RemoteBench {
 protected:
  static constexpr int kDown = 200;
  static constexpr int kUp = 1800;

  /// One frame, 14 ms after the last; true: the remote commands.
  bool send(int switch_raw, bool lost = false) {
    SbusInput sbus;
    sbus.raw.fill(SbusInput::kCentre);
    sbus.raw[4] = static_cast<std::uint16_t>(switch_raw);
    sbus.frame_lost = lost;
    const auto frame = SbusProtocol::encode(sbus);
    for (int i = 0; i < 14; ++i) {
      if (i == 13) protocol_->parse_stream(frame, robot_.now());
      robot_.update(*module_);
      asked_.insert(asked_.end(), robot_.asked().begin(), robot_.asked().end());
    }
    return !robot_.sent().empty();
  }
  bool enables() { return asks(RobotRequest::kEnable) || asks(RobotRequest::kClear); }
};

TEST_F(SbusRemote, AReceiverThatSaysFailsafeIsLost) {
  build(remoteSettings("sbus", "ch3", ""));
  SbusInput sbus;
  sbus.raw.fill(SbusInput::kCentre);
  const auto send = [&] {
    const auto frame = SbusProtocol::encode(sbus);
    for (int i = 0; i < 10; ++i) robot_.update(*module_);
    protocol_->parse_stream(frame, robot_.now());
    robot_.update(*module_);
  };
  for (int i = 0; i < 3; ++i) send();  // the first frame finds the rhythm
  EXPECT_FALSE(robot_.sent().empty());
  sbus.failsafe = true;
  send();
  EXPECT_THAT(robot_.sent(), IsEmpty());
  EXPECT_EQ(module_->outputs()[0], 0.0);
}

TEST_F(SbusRemote, ASwitchThatWentUpInALossEnablesNothingHoweverShortTheLossWas) {
  auto quick = remoteSettings("sbus", "ch3", "ch5");
  quick.own.set("lost_ms", 2000.0);
  build(quick);
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  for (int i = 0; i < 4; ++i) send(kDown);
  for (int i = 0; i < 100; ++i) send(kUp, true);  // 1.4 s: beyond disable_s
  EXPECT_TRUE(asks(RobotRequest::kDisableUnasked));
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(send(kUp));
  EXPECT_FALSE(enables());
  send(kDown);
  send(kDown);
  send(kUp);
  EXPECT_TRUE(send(kUp));
  EXPECT_TRUE(enables());
}

TEST_F(SbusRemote, AFrameThatShowsTheSwitchDownEndsItsCommandsAtOnce) {
  build(remoteSettings("sbus", "ch3", "ch5"));
  for (const int raw : {kDown, kDown, kDown, kUp, kUp}) send(raw);
  send(kUp, true);
  ASSERT_TRUE(send(kUp));
  send(kDown, true);
  EXPECT_FALSE(send(kDown));
  EXPECT_EQ(armed(), 1.0) << "until a second says so";
  send(kDown);
  EXPECT_EQ(armed(), 0.0);
}

TEST_F(SbusRemote, OneFrameWithoutItsFlagsIsNoEndOfALoss) {
  build(remoteSettings("sbus", "ch3", ""));
  for (int i = 0; i < 4; ++i) send(kUp);
  ASSERT_TRUE(send(kUp));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(send(kUp, true));
  EXPECT_FALSE(send(kUp)) << "two wrong bits of a frame that says failsafe";
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(send(kUp, true));
  EXPECT_FALSE(send(kUp));
  EXPECT_TRUE(send(kUp));
}

TEST_F(SbusRemote, AFrameThatTheReceiverLostIsNoGapOfASwitchThatIsUp) {
  build(remoteSettings("sbus", "ch3", "ch5"));
  for (const int raw : {kDown, kDown, kDown, kUp})
    EXPECT_FALSE(send(raw));  // the first frame finds the rhythm
  EXPECT_TRUE(send(kUp));
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(send(kUp, true));
    EXPECT_TRUE(send(kUp));
  }
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(send(kUp, true));  // 112 ms: a gap
  EXPECT_FALSE(send(kUp));
  EXPECT_TRUE(send(kUp));
}

}  // namespace
}  // namespace rc10::test::remote_sbus_test
