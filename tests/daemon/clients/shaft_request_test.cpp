#include "daemon/clients/shaft_request.hpp"

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "config/keys/key_table.hpp"
#include "daemon/clients/request_desk.hpp"
#include "daemon/described_robot.hpp"

namespace rc10::test::shaft_request_test {
namespace {

using namespace std::chrono_literals;

using Values = std::initializer_list<std::pair<const char*, double>>;

link::Request requestOf(Operation operation, Values values, const char* motor) {
  link::Request request;
  request.client = std::string_view{"person"};
  request.session = 1;
  request.seq = 1;
  request.operation = toString(operation);
  request.target = std::string_view{motor};
  for (const auto& [name, value] : values)
    request.values.at(request.value_count++) = {.name = std::string_view{name}, .value = value};
  return request;
}

link::Request handOf(Values values, const char* motor = "right") {
  return requestOf(Operation::kHand, values, motor);
}

link::Request loadOf(Values values) { return requestOf(Operation::kLoad, values, "right"); }

constexpr SimulatedDrive kSecond{.port = 1, .drive = 3, .direction = -1};

TEST(HandRequest, TurnsTheDriveTheWayThatItsMotorReports) {
  const auto order = parseHand(handOf({{"by_deg", 90}, {"speed_rpm", 60}, {"torque_nm", 2}, {"hold_s", 0.5}}),
                               "right", kSecond);
  ASSERT_TRUE(order) << order.error().message;
  EXPECT_EQ(order->of.port, 1U);
  EXPECT_EQ(order->of.drive, 3U);
  const auto& hand = std::get<sim::Hand>(order->act);
  EXPECT_EQ(hand.by_deg, -90.0);
  EXPECT_EQ(hand.speed_rpm, 60.0);
  EXPECT_EQ(hand.torque_nm, 2.0);
  EXPECT_EQ(hand.hold, 500ms);
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

/// Value of a change; NaN: not given.
float valueOf(const ShaftOrder& order, std::string_view name) {
  const auto& change = std::get<sim::LoadChange>(order.act);
  for (std::size_t i = 0; i < sim::kLoadFigures.size(); ++i) {
    if (sim::kLoadFigures.at(i).name == name)
      return change.values.at(i).value_or(std::numeric_limits<float>::quiet_NaN());
  }
  ADD_FAILURE() << name;
  return 0.0F;
}

TEST(LoadRequest, ChangesTheFiguresThatItNames) {
  const auto order = parseLoad(loadOf({{"payload_kg", 0.5}, {"payload_at_m", 0.3}}), "right", kSecond);
  ASSERT_TRUE(order) << order.error().message;
  EXPECT_EQ(order->of.drive, 3U);
  EXPECT_EQ(valueOf(*order, "payload_kg"), 0.5F);
  EXPECT_EQ(valueOf(*order, "payload_at_m"), 0.3F);
  EXPECT_TRUE(std::isnan(valueOf(*order, "inertia_kg_m2")));
  EXPECT_FALSE(std::get<sim::LoadChange>(order->act).back);
  EXPECT_EQ(shaftInWords(*order, "right"), "load: right: payload_kg 0.5, payload_at_m 0.3");
}

TEST(LoadRequest, WithoutValuesTheLoadOfTheStartComesBack) {
  const auto order = parseLoad(loadOf({}), "right", kSecond);
  ASSERT_TRUE(order) << order.error().message;
  EXPECT_TRUE(std::get<sim::LoadChange>(order->act).back);
  EXPECT_EQ(shaftInWords(*order, "right"), "load: right: as at the start");
}

TEST(LoadRequest, EveryKeyOfAChangeIsAFigure) {
  constexpr SimulatedDrive kArm{.payload_at_m = 0.3F};
  for (const auto& key : kLoadChangeSection.keys()) {
    const std::string name{key.name};
    const auto order = parseLoad(loadOf({{name.c_str(), key.range.max}}), "right", kArm);
    EXPECT_EQ(order.has_value(), name != "after_s") << name;
    if (order) {
      EXPECT_EQ(valueOf(*order, name), static_cast<float>(key.range.max));
    }
  }
}

std::string refusalOf(const link::Request& request, const SimulatedDrive& drive = kSecond) {
  const auto order = parseLoad(request, "right", drive);
  return order ? "" : order.error().message;
}

TEST(LoadRequest, RefusesWithTheKeyItsRangeAndARemedy) {
  EXPECT_EQ(refusalOf(loadOf({{"coulomb_nm", -1.0}})),
            "load: coulomb_nm: -1 is below 0 N m; use 0 to 100 N m");
  EXPECT_EQ(refusalOf(loadOf({{"payload_at_m", 11.0}})),
            "load: payload_at_m: 11 is above 10 m; use 0 to 10 m");
  EXPECT_EQ(refusalOf(loadOf({{"gravity_nm", std::numeric_limits<double>::quiet_NaN()}})),
            "load: gravity_nm: is not a number");
  EXPECT_EQ(refusalOf(loadOf({{"gravity_nm", 1.0}, {"gravity_nm", 2.0}})),
            "load: gravity_nm: is given twice; keep one");
  EXPECT_EQ(
      refusalOf(loadOf({{"inertia", 1.0}})),
      "load: there is no value 'inertia': inertia_kg_m2, viscous_nms_per_rad, coulomb_nm, load_torque_nm, "
      "gravity_nm, payload_kg, payload_at_m; did you mean inertia_kg_m2?");
  const auto real = parseLoad(loadOf({{"coulomb_nm", 1.0}}), "right", std::nullopt);
  ASSERT_FALSE(real);
  EXPECT_NE(real.error().message.find("load: 'right' has a real drive"), std::string::npos);
}

TEST(LoadRequest, APayloadNeedsAnArmOfTheRequestOrTheFile) {
  const auto payload = loadOf({{"payload_kg", 1.0}});
  EXPECT_NE(refusalOf(payload).find("give payload_at_m too"), std::string::npos);
  EXPECT_EQ(refusalOf(payload, {.payload_at_m = 0.3F}), "");
  EXPECT_EQ(refusalOf(loadOf({{"payload_kg", 0.0}})), "");
}

class ShaftDesk : public testing::Test {
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

TEST_F(ShaftDesk, ARequestThatWasTakenIsNotTakenAgain) {
  const auto request = handOf({{"by_deg", 90}});
  const auto first = desk.begin(request, speaker, kAnyTime);
  ASSERT_TRUE(first.shaft);
  EXPECT_EQ(first.shaft->response.status, link::ResponseStatus::kOk);
  EXPECT_FALSE(first.order);
  desk.shaftTaken(request, speaker, first.shaft->response);
  const auto again = desk.begin(request, speaker, kAnyTime);
  EXPECT_FALSE(again.shaft);
  ASSERT_TRUE(again.response);
  EXPECT_EQ(again.response->message.view(), "hand: turns right");
}

TEST_F(ShaftDesk, ARequestThatFoundNoRoomIsTriedAgain) {
  const auto request = handOf({{"by_deg", 90}});
  ASSERT_TRUE(desk.begin(request, speaker, kAnyTime).shaft);
  EXPECT_TRUE(desk.begin(request, speaker, kAnyTime).shaft);
}

TEST_F(ShaftDesk, AMotorWithoutASimulatedDriveIsRefused) {
  const auto outcome = desk.begin(handOf({{"by_deg", 90}}, "yaw"), speaker, kAnyTime);
  EXPECT_FALSE(outcome.shaft);
  ASSERT_TRUE(outcome.response);
  EXPECT_EQ(outcome.response->status, link::ResponseStatus::kRefused);
}

}  // namespace
}  // namespace rc10::test::shaft_request_test
