#include "robot_file/at_rest.hpp"

#include <memory>

#include <gmock/gmock.h>

namespace rc10::robot_file::test::at_rest_test {
namespace {

using ::testing::HasSubstr;

struct Robot {
  std::unique_ptr<link::Welcome> welcome = std::make_unique<link::Welcome>();
  std::unique_ptr<link::State> state = std::make_unique<link::State>();
  explicit Robot(MotorStatus second) {
    welcome->motor_count = state->motor_count = 2;
    welcome->motors[0].name = "wheel";
    welcome->motors[1].name = "arm";
    state->motors[0].status = MotorStatus::kReady;
    state->motors[1].status = second;
  }
  [[nodiscard]] std::string why() const {
    const auto result = atRest(*welcome, *state);
    return result ? std::string{} : result.error().message;
  }
};

TEST(AtRest, EveryMotorIsReadyOrOffline) {
  EXPECT_EQ(Robot{MotorStatus::kReady}.why(), "");
  EXPECT_EQ(Robot{MotorStatus::kOffline}.why(), "");
}

TEST(AtRest, AMotorThatObeysOrIsAboutToIsNamed) {
  EXPECT_THAT(Robot{MotorStatus::kActive}.why(), HasSubstr("'arm' is ACTIVE"));
  EXPECT_THAT(Robot{MotorStatus::kEnabling}.why(), HasSubstr("'arm' is ENABLING"));
}

TEST(AtRest, AReadyMotorThatIsHeldBrakedOrDampedIsNamedWithTheWayToLetItGo) {
  for (const auto acting : {Acting::kHold, Acting::kBrake, Acting::kDamp, Acting::kRamp}) {
    Robot robot{MotorStatus::kReady};
    robot.state->motors[1].acting = acting;
    EXPECT_THAT(robot.why(), HasSubstr(std::string{"'arm' is READY, and does what its fallback says ("} +
                                       toString(acting)));
    EXPECT_THAT(robot.why(), HasSubstr("`rc10ctl disable arm` once more"));
  }
}

TEST(AtRest, ARestartIsNoWayAroundAClear) {
  EXPECT_THAT(Robot{MotorStatus::kFault}.why(), HasSubstr("`rc10ctl clear arm` first"));
  Robot stopped{MotorStatus::kReady};
  stopped.state->robot_state = RobotStatus::kEstop;
  EXPECT_THAT(stopped.why(), HasSubstr("ESTOP"));
}

}  // namespace
}  // namespace rc10::robot_file::test::at_rest_test
