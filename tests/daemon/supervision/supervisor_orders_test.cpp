// Requests that are under way at the same time.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "app/angle.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_orders_test {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Field;
using ::testing::SizeIs;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;

class OpenRequestsTest : public ::testing::Test {
 protected:
  OpenRequestsTest() { robot.run(5); }

  /// All of them before the next tick.
  void askToEnable(std::size_t motor, std::size_t times, std::uint64_t first_id) {
    for (std::size_t i = 0; i < times; ++i) {
      Order order;
      order.id = first_id == Order::kFromModule ? first_id : first_id + i;
      order.operation = Operation::kEnable;
      order.motors.set(motor);
      ASSERT_TRUE(robot.exchange().orders.push(order));
    }
  }
  std::vector<OrderResult> answers() {
    std::vector<OrderResult> all;
    robot.exchange().results.consume_all([&](const OrderResult& result) { all.push_back(result); });
    return all;
  }
  MotorStatus status(std::size_t motor) { return robot.motor(motor).status; }

  VirtualRobot robot{twoWheelsAndYaw()};
};

TEST_F(OpenRequestsTest, AsManyEnableRequestsAsClientsMayHaveAreAllAnsweredWhenTheMotorIsActive) {
  askToEnable(kLeft, kMaxOpenRequests, 1);
  robot.run(5);
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  EXPECT_THAT(answers(), AllOf(SizeIs(kMaxOpenRequests), Each(Field(&OrderResult::refused, false))));
}

TEST_F(OpenRequestsTest, OneMoreIsRefusedAndEnablesNothing) {
  askToEnable(kLeft, kMaxOpenRequests, 1);
  robot.tick();
  ASSERT_EQ(status(kLeft), MotorStatus::kEnabling);
  askToEnable(kRight, 1, 1000);
  robot.run(5);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
  const auto all = answers();
  const auto last =
      std::find_if(all.begin(), all.end(), [](const auto& answer) { return answer.id == 1000; });
  ASSERT_NE(last, all.end());
  EXPECT_TRUE(last->refused);
}

TEST_F(OpenRequestsTest, TheAnswerSaysWhichMotorsItHasSwitchedOn) {
  askToEnable(kLeft, 2, 1);
  robot.run(5);
  Order both;
  both.id = 3;
  both.operation = Operation::kEnable;
  both.motors = MotorSet{0b11};
  ASSERT_TRUE(robot.exchange().orders.push(both));
  robot.run(5);
  std::map<std::uint64_t, MotorSet> switched_on;
  for (const auto& answer : answers()) switched_on[answer.id] = answer.switched_on;
  EXPECT_EQ(switched_on[1], MotorSet{0b01});
  EXPECT_EQ(switched_on[2], MotorSet{}) << "it was ENABLING";
  EXPECT_EQ(switched_on[3], MotorSet{0b10});
}

TEST_F(OpenRequestsTest, AZeroOfOneMotorAloneTellsWhatItsFileNeeds) {
  const MotorSet yaw = MotorSet{}.set(2);
  const auto at_0 = robot.orderFor(yaw, Operation::kZero, 0.0);
  const auto at_30 = robot.orderFor(yaw, Operation::kZero, 30.0);
  EXPECT_NEAR(std::fabs(shortestAngle(at_0.zero_deg, at_30.zero_deg)), 30.0, 1e-6);
  EXPECT_TRUE(std::isnan(robot.order(Operation::kZero).zero_deg)) << "it is of one";
}

/// Requests that wait for nothing.
class OtherRequestsTest : public OpenRequestsTest, public ::testing::WithParamInterface<Operation> {};

TEST_P(OtherRequestsTest, AreCarriedOutWhileAsManyAsPossibleWait) {
  askToEnable(kLeft, kMaxOpenRequests, 1);
  robot.tick();
  ASSERT_EQ(status(kLeft), MotorStatus::kEnabling);
  Order order;
  order.id = 1000;
  order.operation = GetParam();
  order.motors.set(kRight);
  ASSERT_TRUE(robot.exchange().orders.push(order));
  robot.run(5);
  const auto all = answers();
  const auto answer =
      std::find_if(all.begin(), all.end(), [](const OrderResult& result) { return result.id == 1000; });
  ASSERT_NE(answer, all.end());
  EXPECT_FALSE(answer->refused);
}

INSTANTIATE_TEST_SUITE_P(All, OtherRequestsTest,
                         ::testing::Values(Operation::kDisable, Operation::kEstop, Operation::kClear,
                                           Operation::kZero, Operation::kSetGains),
                         [](const auto& each) {
                           return "Operation" + std::to_string(static_cast<int>(each.param));
                         });

TEST_F(OpenRequestsTest, ThoseOfModulesTakeNoPlaceOfAClients) {
  askToEnable(kLeft, kMaxOpenRequests, Order::kFromModule);
  robot.tick();
  ASSERT_EQ(status(kLeft), MotorStatus::kEnabling);
  askToEnable(kRight, 1, 1000);
  robot.run(5);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
  EXPECT_THAT(answers(), AllOf(SizeIs(1), Each(Field(&OrderResult::refused, false))));
}

}  // namespace
}  // namespace rc10::test::supervisor_orders_test
