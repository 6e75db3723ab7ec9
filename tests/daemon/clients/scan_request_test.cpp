#include "daemon/clients/scan_request.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "daemon/clients/request_desk.hpp"
#include "daemon/described_robot.hpp"
#include "daemon/link_messages.hpp"

namespace rc10::test::scan_request_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

RobotDescription twoBusRobot() {
  auto robot = describedRobot({"left", "arm"});
  robot.buses = {{"chassis", "can0", 1e6, 0.2F, 0.3F}, {"arm", "can1", 250e3, 0.6F, 0.8F}};
  robot.motors[1].bus = 1;
  return robot;
}

link::Request scanOf(std::string_view bus,
                     std::initializer_list<std::pair<const char*, double>> values = {}) {
  auto request = linkRequest(1, "scan", bus);
  for (const auto& [name, value] : values)
    request.values.at(request.value_count++) = {.name = std::string_view{name}, .value = value};
  return request;
}

TEST(ScanRequest, NamesABusOrItsInterface) {
  const auto robot = twoBusRobot();
  EXPECT_EQ(parseScan(scanOf("arm"), robot)->bus, 1U);
  EXPECT_EQ(parseScan(scanOf("can0"), robot)->bus, 0U);
  EXPECT_EQ(parseScan(scanOf("chasis"), robot).error().message,
            "scan: name one bus, not 'chasis'; the buses are: chassis, arm; did you mean chassis?");
  EXPECT_THAT(parseScan(scanOf(""), robot).error().message, HasSubstr("name one bus"));
}

TEST(ScanRequest, ListensForTwoSecondsUnlessItIsTold) {
  const auto robot = twoBusRobot();
  EXPECT_EQ(parseScan(scanOf("arm"), robot)->listen, 2s);
  EXPECT_FALSE(parseScan(scanOf("arm"), robot)->listen_only);
  const auto told = parseScan(scanOf("arm", {{"listen_s", 0.5}, {"listen_only", 1.0}}), robot);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->listen, 500ms);
  EXPECT_TRUE(told->listen_only);
}

TEST(ScanRequest, RefusesValuesOutOfRangeOrUnknownByName) {
  const auto robot = twoBusRobot();
  for (const double value : {0.4, 61.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(parseScan(scanOf("arm", {{"listen_s", value}}), robot).error().message,
                HasSubstr("use 0.5 to 60"));
  EXPECT_THAT(parseScan(scanOf("arm", {{"listen_ms", 1.0}}), robot).error().message,
              HasSubstr("there is no value 'listen_ms': listen_s and listen_only"));
}

TEST(ScanRequest, QuestionsTakeNoMoreThanHalfOfTheRoomOnTheWire) {
  const auto robot = twoBusRobot();
  EXPECT_EQ(parseScan(scanOf("chassis"), robot)->between, 2ms);
  // 160 bits each way at 250 kbit/s, on a bus of which a fifth is free.
  const auto slow = parseScan(scanOf("arm"), robot)->between;
  EXPECT_GT(slow, 12ms);
  EXPECT_LT(slow, 14ms);
  auto full = robot;
  full.buses[1].predicted_load_worst = 1.2F;
  EXPECT_EQ(parseScan(scanOf("arm"), full)->between, 50ms) << "it is asked all the same";
}

class ScanRights : public ::testing::Test {
 protected:
  static RobotDescription described() {
    auto robot = twoBusRobot();
    robot.buses.push_back({"spare", "can2"});
    return robot;
  }
  [[nodiscard]] std::string refusedTo(Right right, std::vector<std::size_t> motors,
                                      std::string_view bus) const {
    ClientConfig client;
    client.line = 8;
    client.by = ClientConfig::By::kUser;
    client.who = "1000";
    client.rights[static_cast<std::size_t>(right)] = true;
    client.all_motors = motors.empty();
    client.motors = std::move(motors);
    ClientsConfig clients;
    clients.line = 7;
    clients.entries = {client};
    auto permissions = Permissions::resolve({.clients = clients,
                                             .tuning_locked_at = 0,
                                             .clear_local_at = 0,
                                             .file = "robot.yaml",
                                             .motors = {"left", "arm"},
                                             .modules = {}})
                           .value();
    const Admission admission{robot, permissions};
    RequestDesk desk{admission, robot};
    Speaker anna{.user = 1000};
    anna.grants = admission.permissions().ofUser(1000, {});
    return desk.begin(scanOf(bus), anna, kAnyTime).not_permitted;
  }

  RobotDescription robot = described();
};

TEST_F(ScanRights, ItNeedsTheRightToConfigureTheMotorsOfItsBus) {
  EXPECT_EQ(refusedTo(Right::kConfigure, {}, "arm"), "");
  EXPECT_EQ(refusedTo(Right::kConfigure, {1}, "arm"), "");
  EXPECT_THAT(refusedTo(Right::kConfigure, {0}, "arm"), HasSubstr("may not configure arm"));
  EXPECT_THAT(refusedTo(Right::kCommand, {}, "arm"), HasSubstr("may not configure arm"));
}

TEST_F(ScanRights, ABusWithoutMotorsNeedsItForAllOfTheRobot) {
  EXPECT_EQ(refusedTo(Right::kConfigure, {}, "spare"), "");
  EXPECT_THAT(refusedTo(Right::kConfigure, {1}, "spare"), HasSubstr("may not configure left"));
}

}  // namespace
}  // namespace rc10::test::scan_request_test
