#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/clients/request_desk.hpp"
#include "daemon/described_robot.hpp"
#include "daemon/link_messages.hpp"

namespace rc10::test::optional_motor_test {
namespace {

using link::ResponseStatus;
using ::testing::HasSubstr;

class OptionalMotorTest : public ::testing::Test {
 protected:
  link::Response afterFailureOf(std::size_t motor, std::string_view operation) {
    const auto outcome = desk.begin(linkRequest(++seq, operation, operation == "zero" ? "spare" : ""),
                                    {.connection = 1}, kAnyTime);
    OrderResult result;
    result.id = outcome.order.value().id;
    result.motors[motor] = Refusal::kOffline;
    return desk.finish(result).value().response;
  }

  static RobotDescription described() {
    auto robot = describedRobot({"wheel", "spare"});
    robot.motors[1].optional = true;
    return robot;
  }
  RobotDescription robot = described();
  Admission admission{robot};
  RequestDesk desk{admission, robot};
  std::int64_t seq = 0;
};

TEST_F(OptionalMotorTest, MayFailToEnableAndIsNamed) {
  const auto response = afterFailureOf(1, "enable");
  EXPECT_EQ(response.status, ResponseStatus::kOk);
  EXPECT_THAT(std::string(response.message.view()), HasSubstr("spare: offline"));
}

TEST_F(OptionalMotorTest, IsNoSuccessWhereItAloneIsNamed) {
  const auto outcome = desk.begin(linkRequest(++seq, "enable", "spare"), {.connection = 1}, kAnyTime);
  OrderResult result;
  result.id = outcome.order.value().id;
  result.motors[1] = Refusal::kOffline;
  EXPECT_EQ(desk.finish(result).value().response.status, ResponseStatus::kFailed);
}

TEST_F(OptionalMotorTest, DoesNotExcuseAnother) {
  EXPECT_EQ(afterFailureOf(0, "enable").status, ResponseStatus::kFailed);
}

TEST_F(OptionalMotorTest, MayNotFailAnythingElse) {
  EXPECT_EQ(afterFailureOf(1, "zero").status, ResponseStatus::kFailed);
}

}  // namespace
}  // namespace rc10::test::optional_motor_test
