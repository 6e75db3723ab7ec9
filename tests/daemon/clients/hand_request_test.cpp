#include "daemon/clients/hand_request.hpp"

#include <chrono>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "daemon/clients/request_desk.hpp"
#include "daemon/described_robot.hpp"

namespace rc10::test::hand_request_test {
namespace {

using namespace std::chrono_literals;

link::Request handOf(std::initializer_list<std::pair<const char*, double>> values,
                     const char* motor = "right") {
  link::Request request;
  request.client = std::string_view{"person"};
  request.session = 1;
  request.seq = 1;
  request.operation = toString(Operation::kHand);
  request.target = std::string_view{motor};
  for (const auto& [name, value] : values)
    request.values.at(request.value_count++) = {.name = std::string_view{name}, .value = value};
  return request;
}

constexpr SimulatedDrive kSecond{.port = 1, .drive = 3, .direction = -1};

TEST(HandRequest, TurnsTheDriveTheWayThatItsMotorReports) {
  const auto order = parseHand(handOf({{"by_deg", 90}, {"speed_rpm", 60}, {"torque_nm", 2}, {"hold_s", 0.5}}),
                               "right", kSecond);
  ASSERT_TRUE(order) << order.error().message;
  EXPECT_EQ(order->of.port, 1U);
  EXPECT_EQ(order->of.drive, 3U);
  EXPECT_EQ(order->hand.by_deg, -90.0);
  EXPECT_EQ(order->hand.speed_rpm, 60.0);
  EXPECT_EQ(order->hand.torque_nm, 2.0);
  EXPECT_EQ(order->hand.hold, 500ms);
}

TEST(HandRequest, RefusesWhatIsOutOfRangeOrUnknownByName) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [name, value] :
       {std::pair{"by_deg", 36'001.0}, std::pair{"by_deg", kNan}, std::pair{"speed_rpm", 0.0},
        std::pair{"torque_nm", -1.0}, std::pair{"hold_s", 61.0}}) {
    const auto order = parseHand(handOf({{name, value}}), "right", kSecond);
    ASSERT_FALSE(order) << name << " " << value;
    EXPECT_NE(order.error().message.find(name), std::string::npos) << order.error().message;
    EXPECT_NE(order.error().message.find("out of range"), std::string::npos) << order.error().message;
  }
  const auto order = parseHand(handOf({{"by_degs", 1.0}}), "right", kSecond);
  ASSERT_FALSE(order);
  EXPECT_EQ(
      order.error().message,
      "hand: there is no value 'by_degs': by_deg, speed_rpm, torque_nm and hold_s; did you mean by_deg?");
}

TEST(HandRequest, RefusesARealDrive) {
  const auto order = parseHand(handOf({{"by_deg", 1.0}}), "right", std::nullopt);
  ASSERT_FALSE(order);
  EXPECT_NE(order.error().message.find("'right' has a real drive"), std::string::npos);
}

class HandDesk : public testing::Test {
 protected:
  static RobotDescription described() {
    auto robot = describedRobot({"left", "right", "yaw"});
    robot.motors[0].simulated = SimulatedDrive{};
    robot.motors[1].simulated = kSecond;
    return robot;
  }
  RobotDescription robot = described();
  Admission admission{robot};
  RequestDesk desk{admission, robot};
  Speaker speaker{.connection = 7};
};

TEST_F(HandDesk, ARequestThatWasTakenIsNotTakenAgain) {
  const auto request = handOf({{"by_deg", 90}});
  const auto first = desk.begin(request, speaker);
  ASSERT_TRUE(first.hand);
  EXPECT_EQ(first.hand->response.status, link::ResponseStatus::kOk);
  EXPECT_FALSE(first.order);
  desk.handTaken(request, speaker, first.hand->response);
  const auto again = desk.begin(request, speaker);
  EXPECT_FALSE(again.hand);
  ASSERT_TRUE(again.response);
  EXPECT_EQ(again.response->message.view(), "hand: turns right");
}

TEST_F(HandDesk, ARequestThatFoundNoRoomIsTriedAgain) {
  const auto request = handOf({{"by_deg", 90}});
  ASSERT_TRUE(desk.begin(request, speaker).hand);
  EXPECT_TRUE(desk.begin(request, speaker).hand);
}

TEST_F(HandDesk, AMotorWithoutASimulatedDriveIsRefused) {
  const auto outcome = desk.begin(handOf({{"by_deg", 90}}, "yaw"), speaker);
  EXPECT_FALSE(outcome.hand);
  ASSERT_TRUE(outcome.response);
  EXPECT_EQ(outcome.response->status, link::ResponseStatus::kRefused);
}

}  // namespace
}  // namespace rc10::test::hand_request_test
