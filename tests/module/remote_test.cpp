#include "module/remote.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <gmock/gmock.h>

#include "remote_bench.hpp"

namespace rc10::test::remote_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

class Remote : public RemoteBench {};

TEST_F(Remote, ASwitchThatIsUpAtTheStartEnablesNothing) {
  build();
  dbus_.left_switch = Dr16Input::Switch::kUp;
  run(200);
  EXPECT_THAT(asked_, IsEmpty());
  EXPECT_EQ(armed(), 0.0);
  EXPECT_THAT(robot_.sent(), IsEmpty());
}

TEST_F(Remote, ASwitchIsShownDownOnceItCountsAsDown) {
  build();
  dbus_.left_switch = Dr16Input::Switch::kDown;
  while (shown("left_switch") != -1.0) run(1);
  dbus_.left_switch = Dr16Input::Switch::kUp;
  run(60);
  EXPECT_EQ(armed(), 1.0);
  EXPECT_EQ(shown("left_switch"), 1.0);
}

TEST_F(Remote, TheSwitchOfARemoteThatIsBackCountsFromItsSecondFrame) {
  build();
  arm();
  run(500, false);
  run(14);
  EXPECT_EQ(shown("connected"), 0.0) << "one frame may be noise";
  EXPECT_TRUE(std::isnan(shown("left_switch")));
  EXPECT_EQ(armed(), 1.0) << "a short loss";
  run(14);
  EXPECT_EQ(shown("connected"), 1.0);
  EXPECT_EQ(shown("left_switch"), 1.0);
}

TEST_F(Remote, TheSwitchGoingUpEnablesWhatIsReadyAndDownDisablesWhatIsOn) {
  build();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  arm();
  EXPECT_EQ(armed(), 1.0);
  EXPECT_TRUE(asks(RobotRequest::kEnable));
  asked_.clear();
  robot_.motor(0).status = MotorStatus::kActive;
  armSwitch(Dr16Input::Switch::kMiddle);
  ASSERT_FALSE(asked_.empty());
  EXPECT_EQ(asked_.front().request, RobotRequest::kDisable);
  EXPECT_EQ(asked_.front().motor, 0U);
  for (const auto& other : std::span{asked_}.subspan(1))
    EXPECT_EQ(other.request, RobotRequest::kDisableUnasked) << "what is not on may be held";
}

TEST_F(Remote, TheSwitchGoingDownWhereNothingIsOnLetsGoOfNothing) {
  build();
  arm();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;  // an e-stop
  asked_.clear();
  armSwitch(Dr16Input::Switch::kMiddle);
  ASSERT_FALSE(asked_.empty());
  EXPECT_EQ(asked_.front().request, RobotRequest::kDisableUnasked);
}

TEST_F(Remote, TheSwitchGoingDownDisablesWhatAnotherClientHasEnabled) {
  build();
  armSwitch(Dr16Input::Switch::kUp);  // since the start: it enables nothing
  ASSERT_EQ(armed(), 0.0);
  ASSERT_THAT(asked_, IsEmpty());
  armSwitch(Dr16Input::Switch::kDown);
  EXPECT_EQ(disablings(), 2U);
  run(200);
  EXPECT_EQ(disablings(), 2U) << "once: a page may enable with the switch down";
}

TEST_F(Remote, SoItDoesWhenItWasUpAfterALongLoss) {
  build();
  arm();
  run(1200, false);
  run(100);
  ASSERT_EQ(armed(), 0.0);
  ASSERT_EQ(disablings(), 0U);
  armSwitch(Dr16Input::Switch::kMiddle);
  EXPECT_EQ(disablings(), 2U);
}

TEST_F(Remote, ASwitchThatWentDownInALongLossDisablesWhenItIsHeard) {
  build();
  arm();
  run(1200, false);
  armSwitch(Dr16Input::Switch::kDown);
  EXPECT_EQ(disablings(), 2U) << "what was enabled meanwhile";
}

TEST_F(Remote, ASwitchThatIsFirstSeenDownDisablesNothing) {
  build();
  armSwitch(Dr16Input::Switch::kDown);
  run(200);
  EXPECT_THAT(asked_, IsEmpty());
}

TEST_F(Remote, OneDamagedFrameIsNoMoveOfTheSwitch) {
  build();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  const auto damaged = [this](Dr16Input::Switch position) {
    const auto before = std::exchange(dbus_.left_switch, position);
    run(14);
    dbus_.left_switch = before;
    run(60);
  };
  armSwitch(Dr16Input::Switch::kDown);
  damaged(Dr16Input::Switch::kUp);
  EXPECT_THAT(asked_, IsEmpty());
  EXPECT_EQ(armed(), 0.0);
  arm();
  ASSERT_EQ(armed(), 1.0);
  asked_.clear();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kActive;
  damaged(Dr16Input::Switch::kDown);
  EXPECT_THAT(asked_, IsEmpty());
  EXPECT_EQ(armed(), 1.0);
}

TEST_F(Remote, OneDamagedFrameStartsNothing) {
  struct Damage {
    const char* channel;
    void (*of)(Dr16Input&);
  };
  for (const auto& [channel, of] :
       {Damage{"key_e", [](Dr16Input& frame) { frame.keys = 0x00C0; }},
        Damage{"mouse_left", [](Dr16Input& frame) { frame.mouse_left = true; }},
        Damage{"right_switch", [](Dr16Input& frame) { frame.right_switch = Dr16Input::Switch::kUp; }},
        Damage{"right_y", [](Dr16Input& frame) { frame.right_vertical = 660; }},
        Damage{"wheel", [](Dr16Input& frame) { frame.wheel = -660; }}}) {
    SCOPED_TRACE(channel);
    dbus_ = {};
    dbus_.right_switch = Dr16Input::Switch::kMiddle;
    build(remoteSettings("dbus", channel, ""));
    run(100);
    const auto good = dbus_;
    of(dbus_);
    const auto damaged = dbus_;
    for (int i = 0; i < 56; ++i) {
      if (i == 14) dbus_ = good;
      run(1);
      ASSERT_EQ((robot_.sent().at({0, 0})), 0.0);
      ASSERT_NEAR(shown(channel), 0.0, 0.05);
    }
    dbus_ = damaged;
    run(28);
    EXPECT_NE((robot_.sent().at({0, 0})), 0.0) << "a second frame agrees";
  }
}

TEST_F(Remote, NoSingleFrameCommandsAfterAGap) {
  build(remoteSettings("dbus", "right_y", ""));
  run(100);
  run(200, false);
  dbus_.right_vertical = 660;
  run(14);
  dbus_.right_vertical = 0;
  for (int i = 0; i < 42; ++i) {
    run(1);
    const auto sent = robot_.sent().find({0, 0});
    if (sent != robot_.sent().end()) {
      ASSERT_EQ(sent->second, 0.0);
    }
  }
  EXPECT_TRUE(robot_.sent().contains({0, 0}));
}

TEST_F(Remote, NoSingleFrameOfALossPutsItsEndOff) {
  build();
  arm();
  run(900, false);
  run(14);  // noise that looks like a frame
  EXPECT_THAT(robot_.sent(), IsEmpty());
  EXPECT_EQ(shown("connected"), 0.0);
  run(200, false);
  EXPECT_TRUE(asks(RobotRequest::kDisableUnasked));
}

// Else the input that is missing would fall and rise: a joint would be homed anew.
TEST_F(Remote, AfterAGapItCommandsAllOrNothing) {
  build(remoteSettings("dbus", "right_switch", ""));
  dbus_.right_switch = Dr16Input::Switch::kUp;
  run(100);
  run(200, false);
  for (int frame = 0; frame < 5; ++frame) {
    dbus_.right_switch = frame == 1 ? Dr16Input::Switch::kMiddle : Dr16Input::Switch::kUp;
    run(14);
    EXPECT_EQ(robot_.sent().contains({0, 0}), robot_.sent().contains({0, 1})) << "the constant";
    EXPECT_EQ(robot_.sent().contains({0, 0}), frame >= 3);
  }
}

// Whenever it would try to enable again.
TEST_F(Remote, ASwitchThatGoesDownEnablesNoMoreThoughADamagedFrameShowsItUp) {
  for (int wait = 0; wait < 224; wait += 14) {
    build();
    for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
    arm();
    run(wait);
    dbus_.left_switch = Dr16Input::Switch::kDown;
    do run(1);
    while (since_frame_ != 0);
    asked_.clear();
    for (const auto position : {Dr16Input::Switch::kUp, Dr16Input::Switch::kDown}) {
      dbus_.left_switch = position;
      run(14);
    }
    EXPECT_FALSE(asks(RobotRequest::kEnable)) << wait;
  }
}

TEST_F(Remote, OneDamagedFrameOfTheSwitchInterruptsNoInputForLong) {
  build();
  arm();
  dbus_.left_switch = Dr16Input::Switch::kDown;
  do run(1);
  while (since_frame_ != 0);
  dbus_.left_switch = Dr16Input::Switch::kUp;
  run(14);
  EXPECT_FALSE(robot_.sent().empty()) << "inputs are valid for 20 ms";
}

TEST_F(Remote, TheEndOfAnEstopEnablesNothing) {
  build();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  robot_.setState(RobotStatus::kEstop);
  arm();
  EXPECT_FALSE(asks(RobotRequest::kEnable));
  robot_.setState(RobotStatus::kRun);
  run(100);
  EXPECT_FALSE(asks(RobotRequest::kEnable)) << "the switch went up before";
  armSwitch(Dr16Input::Switch::kMiddle);
  arm();
  EXPECT_TRUE(asks(RobotRequest::kEnable));
}

TEST_F(Remote, SticksBecomeInputsWhileItIsArmed) {
  build();
  dbus_.right_vertical = 660;
  run(50);
  EXPECT_THAT(robot_.sent(), IsEmpty());
  arm();
  EXPECT_THAT(robot_.sent(), Contains(Pair(std::pair<std::size_t, std::size_t>{0, 0}, 2.0)));
  EXPECT_THAT(robot_.sent(), Contains(Pair(std::pair<std::size_t, std::size_t>{0, 1}, 2.0)))
      << "the constant";
  dbus_.right_vertical = 60;  // within the deadband
  run(30);
  EXPECT_THAT(robot_.sent(), Contains(Pair(std::pair<std::size_t, std::size_t>{0, 0}, 0.0)));
  dbus_.right_vertical = -363;  // 0.55: half of what lies beyond the deadband
  run(30);
  EXPECT_NEAR((robot_.sent().at({0, 0})), -1.0, 1e-6);
}

TEST_F(Remote, WithoutAnArmSwitchItCommandsWheneverItIsHeard) {
  build(remoteSettings("dbus", "right_y", ""));
  dbus_.right_vertical = 660;
  run(50);
  EXPECT_FALSE(robot_.sent().empty());
}

TEST_F(Remote, LostItCommandsNothingWithinTheTimeThatIsSet) {
  build();
  arm();
  run(100, false);
  EXPECT_THAT(robot_.sent(), IsEmpty());
  EXPECT_THAT(events_, Contains(0U));
  EXPECT_FALSE(asks(RobotRequest::kDisableUnasked));
  run(30);
  EXPECT_FALSE(robot_.sent().empty()) << "a short gap: it goes on, the switch is still up";
}

TEST_F(Remote, LostForLongItDisablesAllAndTheSwitchMustGoDownAndUpAgain) {
  build();
  arm();
  asked_.clear();
  run(1200, false);
  EXPECT_TRUE(asks(RobotRequest::kDisableUnasked)) << "what an e-stop holds stays held";
  EXPECT_FALSE(asks(RobotRequest::kDisable));
  EXPECT_EQ(armed(), 0.0);
  asked_.clear();
  run(100);
  EXPECT_THAT(robot_.sent(), IsEmpty());
  EXPECT_THAT(asked_, IsEmpty());
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  arm();
  EXPECT_TRUE(asks(RobotRequest::kEnable));
  EXPECT_EQ(armed(), 1.0);
}

TEST_F(Remote, AfterAPowerCutTheSwitchAloneRecoversTheRobot) {
  build();
  robot_.motor(0).status = MotorStatus::kFault;
  robot_.motor(1).status = MotorStatus::kOffline;
  arm();
  EXPECT_TRUE(asks(RobotRequest::kClear));
  robot_.motor(0).status = MotorStatus::kReady;
  robot_.motor(1).status = MotorStatus::kReady;
  asked_.clear();
  run(250);
  EXPECT_TRUE(asks(RobotRequest::kEnable)) << "drives that come back a little later too";
}

TEST_F(Remote, UnheardItNeitherClearsNorEnables) {
  build();
  robot_.motor(0).status = MotorStatus::kOffline;
  arm();
  run(200, false);
  asked_.clear();
  robot_.motor(0).status = MotorStatus::kFault;
  run(250, false);
  robot_.motor(0).status = MotorStatus::kReady;
  run(250, false);
  EXPECT_THAT(asked_, IsEmpty());
  run(250);
  EXPECT_TRUE(asks(RobotRequest::kEnable)) << "heard again within the time of the switch";
}

TEST_F(Remote, ADisableEndsTheArmingAndOnlyTheSwitchBeginsAnother) {
  build();
  robot_.motor(0).status = MotorStatus::kReady;
  robot_.motor(1).status = MotorStatus::kOffline;
  arm();
  ASSERT_TRUE(asks(RobotRequest::kEnable));
  robot_.motor(0).status = MotorStatus::kEnabling;
  run(100);
  asked_.clear();
  robot_.disable();
  robot_.motor(0).status = MotorStatus::kReady;
  robot_.motor(1).status = MotorStatus::kReady;  // its drive has come back meanwhile
  run(3500);
  EXPECT_THAT(asked_, IsEmpty());
  armSwitch(Dr16Input::Switch::kMiddle);
  asked_.clear();
  arm();
  EXPECT_TRUE(asks(RobotRequest::kEnable));
}

TEST_F(Remote, AMotorWhoseDriveHasRefusedIsAskedForAgain) {
  build();
  robot_.motor(0).status = MotorStatus::kReady;
  arm();
  robot_.motor(0).status = MotorStatus::kEnabling;
  run(100);
  asked_.clear();
  robot_.motor(0).status = MotorStatus::kReady;
  run(250);
  EXPECT_TRUE(asks(RobotRequest::kEnable));
}

TEST_F(Remote, AfterAGapItActsOnTheSwitchOfNoSingleFrame) {
  loseLinkWhileArmed(MotorStatus::kFault);
  run(14);
  ASSERT_LT(shown("age_ms"), 14.0);
  EXPECT_THAT(robot_.sent(), IsEmpty()) << "the first frame: the switch may be down";
  EXPECT_THAT(asked_, IsEmpty());
  run(14);
  EXPECT_FALSE(robot_.sent().empty()) << "still up: a short gap";
  run(200);
  EXPECT_TRUE(asks(RobotRequest::kClear));
}

TEST_F(Remote, ASwitchThatWentDownInAGapNeitherEnablesNorCommands) {
  loseLinkWhileArmed(MotorStatus::kReady);
  dbus_.left_switch = Dr16Input::Switch::kDown;
  for (int i = 0; i < 100; ++i) {
    run(1);
    ASSERT_THAT(robot_.sent(), IsEmpty());
  }
  EXPECT_FALSE(asks(RobotRequest::kEnable));
  EXPECT_TRUE(asks(RobotRequest::kDisable));
  EXPECT_EQ(armed(), 0.0);
}

TEST_F(Remote, ItsDriverIsAClientWhileItIsHeard) {
  build();
  run(50);
  EXPECT_TRUE(robot_.clientHeard());
  EXPECT_EQ(robot_.now() - robot_.clientSaid(), std::chrono::milliseconds{since_frame_ + 1})
      << "by its last frame";
  run(200, false);
  EXPECT_FALSE(robot_.clientHeard());
}

TEST_F(Remote, MotorsAreEnabledInOneRequest) {
  build();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  armSwitch(Dr16Input::Switch::kDown);
  armSwitch(Dr16Input::Switch::kUp);
  EXPECT_EQ(robot_.largestRequest(), 2U);
}

TEST_F(Remote, AMotorThatFailsRightAfterItWasEnabledIsNotEnabledAgain) {
  build();
  arm();
  asked_.clear();
  robot_.motor(0).status = MotorStatus::kReady;  // its drive was restarted
  run(500);
  EXPECT_THAT(asked_, IsEmpty());
}

TEST_F(Remote, WhatFailsLaterStaysDown) {
  build();
  arm();
  run(3500);
  asked_.clear();
  robot_.motor(0).status = MotorStatus::kFault;
  run(1000);
  EXPECT_THAT(asked_, IsEmpty());
}

TEST_F(Remote, AnEstopIsNotItsToClear) {
  build();
  robot_.setState(RobotStatus::kEstop);
  robot_.motor(0).status = MotorStatus::kFault;
  armSwitch(Dr16Input::Switch::kDown);
  asked_.clear();
  armSwitch(Dr16Input::Switch::kUp);
  EXPECT_THAT(asked_, IsEmpty());
  robot_.setState(RobotStatus::kRun);
  run(500);
  EXPECT_THAT(asked_, IsEmpty()) << "the switch went up before its end";
  armSwitch(Dr16Input::Switch::kDown);
  armSwitch(Dr16Input::Switch::kUp);
  EXPECT_TRUE(asks(RobotRequest::kClear)) << "of the fault";
}

TEST(RemoteType, NamesTheChannelsThatThereAre) {
  EXPECT_THAT(remoteType().build(remoteSettings("sbus", "right_y", ""), outlineOf(1)).error().message,
              HasSubstr("sticks: there is no channel 'right_y'; there are ch1, ch2"));
  EXPECT_THAT(remoteType().build(remoteSettings("dbus", "right_y", "ch5"), outlineOf(1)).error().message,
              HasSubstr("arm_channel: there is no channel 'ch5'; there are right_x"));
}

}  // namespace
}  // namespace rc10::test::remote_test
