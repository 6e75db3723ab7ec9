#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_rig.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::robot_moves_test {
namespace {

using namespace std::chrono_literals;
using namespace rc10::literals;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using Outcome = MoveResult::Outcome;

// ---- moves

TEST_F(RobotTest, AMoveIsDoneWhenTheMotorIsThere) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("lift").total_angle_deg = 719.0;
  }
  see(200ms);
  see(100ms);
  see(100ms);
  const auto result = move.get();
  EXPECT_EQ(result.outcome, Outcome::kDone) << result.reason;
  EXPECT_EQ(result.angle_deg, 719.0);
}

TEST_F(RobotTest, AMoveThatCannotBeginHasFailedAtOnce) {
  connect();
  see();
  auto move = robot_->motor("lift").moveTo(720_deg);
  const auto result = move.get();
  EXPECT_EQ(result.outcome, Outcome::kFailed);
  EXPECT_EQ(result.reason, "lift is READY: enable it first");
}

TEST_F(RobotTest, AMotorThatWasJustEnabledMovesThoughTheStatesAreOlder) {
  connect();
  see();
  {
    const std::lock_guard lock(rc10d_.mutex);
    rc10d_.shows_enabled = false;
  }
  auto enabled = std::async(std::launch::async, [&] { return robot_->enable({"lift"}).has_value(); });
  // As soon as the answer is there.
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!robot_->motor("lift").setTarget(Setpoint::totalAngle(10_deg)) &&
         std::chrono::steady_clock::now() < end) {
  }
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  see();  // READY, and older than the answer
  EXPECT_NE(move.wait_for(0s), std::future_status::ready);
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("lift").status = motor_state_t::STATUS_ACTIVE;
  }
  see();
  EXPECT_TRUE(enabled.get());
  const auto sent = rc10d_.commands().size();
  ASSERT_TRUE(rc10d_.awaitCommands(sent + 2)) << "it is held";
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("lift").status = motor_state_t::STATUS_READY;
  }
  see(500ms);
  EXPECT_EQ(move.get().reason, "lift is READY: enable it first") << "and this is news";
}

TEST_F(RobotTest, AMoveTimesOut) {
  connectEnabled();
  const auto result = robot_->motor("lift").moveTo(720_deg, 2_deg, 10ms).get();
  EXPECT_EQ(result.outcome, Outcome::kTimeout) << result.reason;
}

TEST_F(RobotTest, AnotherTargetEndsAMove) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  ASSERT_TRUE(robot_->motor("lift").brake());
  const auto result = move.get();
  EXPECT_EQ(result.outcome, Outcome::kFailed);
  EXPECT_EQ(result.reason, "lift was given another target");
}

TEST_F(RobotTest, AFaultEndsAMove) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("lift").status = motor_state_t::STATUS_FAULT;
    fakeMotor("lift").fault_text = "stalled";
  }
  see(500ms);
  EXPECT_THAT(move.get().reason, HasSubstr("in FAULT (stalled)"));
}

TEST_F(RobotTest, LeavingEndsAMove) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  robot_.reset();
  EXPECT_THAT(move.get().reason, HasSubstr("let go of the robot"));
}

// ---- leaving

TEST_F(RobotTest, LeavingIsATimeoutAtOnce) {
  connect();
  ASSERT_TRUE(robot_->enable({"lift", "wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  ASSERT_TRUE(robot_->close());
  ASSERT_TRUE(rc10d_.awaitCommand([](const command_t& command) { return command.validity_ms == 1; }));
  const auto last = rc10d_.commands().back();
  ASSERT_EQ(last.setpoint_count, 1);
  EXPECT_EQ(last.setpoints[0].mode, +setpoint_t::MODE_VELOCITY)
      << "COAST would leave on_timeout nothing to do";
  EXPECT_EQ(last.setpoints[0].value, 60.0);
  EXPECT_THAT(rc10d_.operations(), Not(Contains(HasSubstr("disable"))));
}

TEST_F(RobotTest, LeavingEndsNoTargetThatIsNotHeldAnyMore) {
  connect();
  ASSERT_TRUE(robot_->enable({"wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(robot_->motor("wheel").coast());
  ASSERT_TRUE(rc10d_.awaitCommand(
      [](const command_t& command) { return command.setpoints[0].mode == +setpoint_t::MODE_COAST; }));
  const auto sent = rc10d_.commands().size();
  ASSERT_TRUE(robot_->close());
  EXPECT_EQ(rc10d_.commands().size(), sent);
}

TEST_F(RobotTest, LeavingMayDisableAndNothingElse) {
  auto leaving = options();
  leaving.at_end = AtEnd::kDisable;
  connect(leaving);
  ASSERT_TRUE(robot_->enable({"wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(robot_->close());
  EXPECT_THAT(rc10d_.operations(), Contains("disable wheel"));
  const auto last = rc10d_.requests().back();
  ASSERT_EQ(last.value_count, 1);
  EXPECT_EQ(last.values[0].name, "at_end") << "what an e-stop holds stays held";
  EXPECT_EQ(last.values[0].value, 1.0);
  for (const auto& command : rc10d_.commands()) EXPECT_NE(command.setpoints[0].mode, +setpoint_t::MODE_COAST);
}

TEST_F(RobotTest, LeavingEndsWhatItCommandedAndDoesNotDisable) {
  for (const bool resends : {true, false}) {
    auto leaving = options();
    if (!resends) leaving.resend = 0ms;
    leaving.at_end = resends ? AtEnd::kDisable : AtEnd::kTimeout;
    connect(leaving);
    fakeMotor("wheel").status = motor_state_t::STATUS_ACTIVE;  // by somebody else
    see(1s);
    ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
    ASSERT_TRUE(robot_->close());
    ASSERT_TRUE(rc10d_.awaitCommand([](const command_t& command) { return command.validity_ms == 1; }));
    EXPECT_EQ(rc10d_.commands().back().setpoints[0].mode, +setpoint_t::MODE_VELOCITY);
    EXPECT_THAT(rc10d_.operations(), IsEmpty());
    const std::lock_guard lock(rc10d_.mutex);
    rc10d_.received.clear();
  }
}

TEST_F(RobotTest, LeavingMayCoastAndDisable) {
  auto leaving = options();
  leaving.at_end = AtEnd::kCoast;
  connect(leaving);
  ASSERT_TRUE(robot_->enable({"lift", "wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  ASSERT_TRUE(robot_->close());
  const auto last = rc10d_.commands().back();
  ASSERT_EQ(last.setpoint_count, 1);
  EXPECT_EQ(last.setpoints[0].motor, "wheel");
  EXPECT_EQ(last.setpoints[0].mode, +setpoint_t::MODE_COAST);
  EXPECT_THAT(rc10d_.operations(), Contains("disable lift,wheel"));
  EXPECT_FALSE(robot_->motor("wheel").setTargetRPM(60_rpm));
  EXPECT_EQ(rc10d_.commands().back().seq, last.seq);
}

TEST_F(RobotTest, LeavingDisablesNothingThatItHasNotEnabled) {
  connect();
  see();
  ASSERT_TRUE(robot_->close());
  EXPECT_THAT(rc10d_.operations(), IsEmpty());
}

}  // namespace
}  // namespace test::robot_moves_test
}  // namespace robot_client
}  // namespace rc10
