#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_rig.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::robot_requests_test {
namespace {

using namespace std::chrono_literals;
using namespace rc10::literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = RequestError::Kind;

// ---- requests

TEST_F(RobotTest, AfterEnableTheStateShowsIt) {
  connect();
  ASSERT_TRUE(robot_->enable({"lift", "yaw"}));
  EXPECT_EQ(robot_->motor("lift").state().status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor("wheel").state().status, MotorStatus::kReady);
  EXPECT_THAT(rc10d_.operations(), ElementsAre("enable lift,yaw"));
}

TEST_F(RobotTest, ALostRequestIsRepeatedAndCarriedOutOnce) {
  rc10d_.deaf_to_requests = 2;
  connect();
  ASSERT_TRUE(robot_->request("clear", "", {}, kPatience));
  EXPECT_GE(rc10d_.asked.size(), 3U);
  EXPECT_EQ(rc10d_.asked[0].seq, rc10d_.asked[2].seq);
  EXPECT_THAT(rc10d_.operations(), ElementsAre("clear"));
}

TEST_F(RobotTest, AFailureHasAReasonForEachMotor) {
  rc10d_.verdicts["enable"] = {+response_t::STATUS_FAILED,
                               "enable: 1 of 3 motors (lift, yaw: offline: no power)"};
  connect();
  see();
  const auto answer = robot_->enable();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kFailed);
  ASSERT_EQ(answer.error().motors.size(), 2U);
  EXPECT_EQ(answer.error().motors[1].motor, "yaw");
  EXPECT_EQ(answer.error().motors[1].reason, "offline: no power");
}

TEST_F(RobotTest, ARefusalCarriesTheDaemonsWords) {
  rc10d_.verdicts["zero"] = {+response_t::STATUS_REFUSED, "the robot is stopping"};
  connect();
  const auto answer = robot_->motor("lift").zero(90_deg);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kRefused);
  EXPECT_EQ(answer.error().message, "zero refused: the robot is stopping");
  ASSERT_EQ(rc10d_.asked.size(), 1U);
  EXPECT_EQ(rc10d_.asked[0].values[0].name, "angle_deg");
  EXPECT_EQ(rc10d_.asked[0].values[0].value, 90.0);
}

TEST_F(RobotTest, GainsAreToldAndSet) {
  connect();
  ASSERT_TRUE(robot_->motor("lift").gains(kPatience));
  ASSERT_TRUE(robot_->motor("lift").setGains({{"velocity.kp", 0.4}}, kPatience));
  EXPECT_THAT(rc10d_.operations(), ElementsAre("get_config lift", "set_gains lift"));
  EXPECT_EQ(rc10d_.asked.back().values[0].name, "velocity.kp");
  EXPECT_EQ(rc10d_.asked.back().values[0].value, 0.4);
}

TEST_F(RobotTest, NoAnswerSaysWhatToCheck) {
  rc10d_.deaf_to_requests = 1000;
  connect();
  const auto answer = robot_->disable({}, 5ms);
  rc10d_.deaf_to_requests = 0;
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kNoAnswer);
  EXPECT_THAT(answer.error().message, HasSubstr("is rc10d running"));
}

TEST_F(RobotTest, AMotorThatDoesNotExistIsNotAskedFor) {
  connect();
  see();
  EXPECT_EQ(robot_->enable({"lft"}).error().kind, Kind::kNotSent);
  EXPECT_EQ(robot_->enable({"lift,yaw"}).error().kind, Kind::kNotSent);
  EXPECT_EQ(robot_->enable({""}).error().kind, Kind::kNotSent);
  EXPECT_THAT(rc10d_.operations(), IsEmpty());
}

TEST_F(RobotTest, AnEstopIsRepeatedUntilTheStateShowsIt) {
  connect();
  see();
  rc10d_.shows_estop = false;
  std::thread later([&] {
    EXPECT_TRUE(rc10d_.awaitRequests(4));
    const std::lock_guard lock(rc10d_.mutex);
    rc10d_.robot_state = robot_state_t::STATE_ESTOP;
  });
  EXPECT_TRUE(robot_->estop(kPatience));
  later.join();
  EXPECT_THAT(rc10d_.operations(), ElementsAre("estop"));
}

TEST_F(RobotTest, AnEstopThatDoesNotShowSaysToUseTheHardware) {
  connect();
  see();
  rc10d_.shows_estop = false;
  const auto stopped = robot_->estop(5ms);
  ASSERT_FALSE(stopped);
  EXPECT_THAT(stopped.error().message, HasSubstr("hardware emergency stop"));
}

TEST_F(RobotTest, LeavingGoesOnWithAnEstopThatNoStateShowsYet) {
  connect();
  see();
  rc10d_.shows_estop = false;
  ASSERT_FALSE(robot_->estop(5ms));
  const std::size_t sent = rc10d_.requests().size();
  std::thread later([&] {
    EXPECT_TRUE(rc10d_.awaitRequests(sent + 2));
    const std::lock_guard lock(rc10d_.mutex);
    rc10d_.robot_state = robot_state_t::STATE_ESTOP;
  });
  EXPECT_TRUE(robot_->close());
  later.join();
}

TEST_F(RobotTest, AStopInVainEndsTheTargetsOfItsMotors) {
  const std::pair<std::int8_t, std::string> refused{+response_t::STATUS_REFUSED, "too many at once"};
  rc10d_.verdicts = {{"disable", refused}, {"estop", refused}};
  connectEnabled();
  see();
  const std::vector<std::function<RequestResult()>> stops{
      [&] { return robot_->disable({"lift"}); },
      [&] { return robot_->disable(); },
      [&] { return robot_->disable({"lift", "lfit"}); },
      [&] { return robot_->request("disable", "yaw,lift"); },
      [&] { return robot_->request("disable", ""); },
      [&] { return robot_->request("estop", ""); },
  };
  for (const auto& stop : stops) {
    ASSERT_TRUE(robot_->motor("lift").setTarget(Setpoint::totalAngle(10_deg)));
    EXPECT_FALSE(stop());
    see();  // all that was sent before has arrived
    const auto before = rc10d_.commands().size();
    ASSERT_TRUE(robot_->motor("wheel").setTarget(Setpoint::totalAngle(10_deg)));
    ASSERT_TRUE(rc10d_.awaitCommands(before + 4));
    const auto commands = rc10d_.commands();
    for (auto sent = before; sent < commands.size(); ++sent) {
      for (const auto& order : commands[sent].setpoints) EXPECT_EQ(order.motor, "wheel");
    }
  }
}

TEST_F(RobotTest, AnEstopInACallbackDoesNotWait) {
  connect();
  std::promise<bool> stopped;
  robot_->onState([&](const RobotState&) {
    robot_->onState(nullptr);
    stopped.set_value(robot_->estop().has_value());
  });
  rc10d_.publishState();
  EXPECT_TRUE(stopped.get_future().get());
  EXPECT_TRUE(rc10d_.awaitRequests(1));
}

}  // namespace
}  // namespace test::robot_requests_test
}  // namespace robot_client
}  // namespace rc10
