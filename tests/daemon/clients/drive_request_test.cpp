// `configure-drive`: what is asked, and what the supervisor lets happen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>

#include "daemon/clients/drive_request.hpp"
#include "daemon/clients/request_desk.hpp"
#include "daemon/described_robot.hpp"
#include "daemon/link_messages.hpp"
#include "daemon/robot_of_text.hpp"
#include "daemon/virtual_robot.hpp"
#include "drives/damiao/damiao_setup.hpp"
#include "drives/myactuator/myactuator_setup.hpp"

namespace rc10::test::drive_request_test {
namespace {

using link::ResponseStatus;
using ::testing::HasSubstr;
using Values = std::initializer_list<std::pair<std::string_view, double>>;

class DriveRequestTest : public ::testing::Test {
 protected:
  link::Request ask(std::string_view motor, Values values) {
    auto request = linkRequest(++seq_, toString(Operation::kConfigure), motor);
    for (const auto& [name, value] : values) request.values[request.value_count++] = {name, value};
    return request;
  }
  std::string refusal(const link::Request& request) {
    const auto outcome = desk.begin(request, {.connection = 1}, kAnyTime);
    EXPECT_FALSE(outcome.order);
    if (!outcome.response) return "no response";
    EXPECT_EQ(outcome.response->status, ResponseStatus::kRefused);
    return std::string(outcome.response->message.view());
  }
  std::string refusal(Values values) { return refusal(ask("arm", values)); }

  static RobotDescription described() {
    auto robot = describedRobot({"arm", "hip", "wheel"});
    robot.motors[0].setup = &damiaoSetup();
    robot.motors[1].setup = &myactuatorSetup();
    return robot;
  }
  RobotDescription robot = described();
  Admission admission{robot};
  RequestDesk desk{admission, robot};

 private:
  std::int64_t seq_ = 0;
};

TEST_F(DriveRequestTest, BecomesAnOrderForOneDrive) {
  const auto outcome =
      desk.begin(ask("arm", {{"timeout_ms", 100}, {"save", 1}}), {.connection = 1}, kAnyTime);
  ASSERT_TRUE(outcome.order);
  EXPECT_EQ(outcome.order->operation, Operation::kConfigure);
  EXPECT_EQ(outcome.order->motors, MotorSet{0b001});
  ASSERT_EQ(outcome.order->drive.count, 1U);
  EXPECT_EQ(damiaoSetup().settings[outcome.order->drive.values[0].setting].name, "timeout_ms");
  EXPECT_EQ(outcome.order->drive.values[0].value, 100.0);
  EXPECT_TRUE(outcome.order->drive.save);
}

TEST_F(DriveRequestTest, SaysWhetherToStore) {
  EXPECT_THAT(refusal({{"timeout_ms", 100}}), HasSubstr("save"));
  EXPECT_THAT(refusal({{"timeout_ms", 100}, {"save", 2}}), HasSubstr("save"));
  EXPECT_FALSE(desk.begin(ask("arm", {{"timeout_ms", 100}, {"save", 0}}), {.connection = 1}, kAnyTime)
                   .order->drive.save);
}

TEST_F(DriveRequestTest, IsRefusedWhenAValueIsNone) {
  EXPECT_THAT(refusal({{"timeout_ms", 1e6}, {"save", 1}}), HasSubstr("0 to 10000"));
  EXPECT_THAT(refusal({{"timeout_ms", std::nan("")}, {"save", 1}}), HasSubstr("finite"));
  EXPECT_THAT(refusal({{"timeout_ms", std::numeric_limits<double>::infinity()}, {"save", 1}}),
              HasSubstr("finite"));
  EXPECT_THAT(refusal({{"control_mode", 1.5}, {"save", 1}}), HasSubstr("whole"));
  EXPECT_THAT(refusal({{"colour", 1}, {"save", 1}}), HasSubstr("timeout_ms"));
  EXPECT_THAT(refusal({{"timeout_ms", 1}, {"timeout_ms", 2}, {"save", 1}}), HasSubstr("twice"));
  EXPECT_THAT(refusal({{"save", 1}}), HasSubstr("name a setting"));
}

TEST_F(DriveRequestTest, NamesOneMotor) {
  EXPECT_THAT(refusal(ask("", {{"timeout_ms", 1}, {"save", 1}})), HasSubstr("one motor"));
  EXPECT_THAT(refusal(ask("arm,hip", {{"timeout_ms", 1}, {"save", 1}})), HasSubstr("one motor"));
  EXPECT_THAT(refusal(ask("leg", {{"timeout_ms", 1}, {"save", 1}})), HasSubstr("no motor"));
}

TEST_F(DriveRequestTest, ADriveWithoutSettingsSaysWhatToUse) {
  EXPECT_THAT(refusal(ask("wheel", {{"timeout_ms", 1}, {"save", 1}})), HasSubstr("tool"));
}

TEST_F(DriveRequestTest, ADriveThatStoresAtOnceIsNotWrittenWithout) {
  EXPECT_THAT(refusal(ask("hip", {{"timeout_ms", 1}, {"save", 0}})), HasSubstr("save has to be 1"));
}

TEST_F(DriveRequestTest, WhoTheDriveIsChangesLastAndOneAtATime) {
  const auto outcome =
      desk.begin(ask("arm", {{"id", 5}, {"timeout_ms", 7}, {"save", 1}}), {.connection = 1}, kAnyTime);
  ASSERT_TRUE(outcome.order);
  EXPECT_EQ(damiaoSetup().settings[outcome.order->drive.values[1].setting].name, "id");
  EXPECT_THAT(refusal({{"id", 5}, {"master_id", 21}, {"save", 1}}), HasSubstr("one change of ids"));
}

TEST_F(DriveRequestTest, IsAnsweredWithWhatWasDone) {
  const auto outcome = desk.begin(ask("arm", {{"id", 5}, {"save", 1}}), {.connection = 1}, kAnyTime);
  OrderResult result;
  result.id = outcome.order->id;
  const auto answer = desk.finish(result);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->response.status, ResponseStatus::kOk);
  EXPECT_THAT(std::string(answer->response.message.view()), HasSubstr("arm: id = 5, stored; "));
}

TEST_F(DriveRequestTest, IsAnsweredWithWhatCouldNotBeDone) {
  const auto outcome = desk.begin(ask("arm", {{"timeout_ms", 5}, {"p_max_rad", 10}, {"save", 1}}),
                                  {.connection = 1}, kAnyTime);
  OrderResult result;
  result.id = outcome.order->id;
  result.motors[0] = Refusal::kNotConfirmed;
  result.drive_value = 1;
  const auto answer = desk.finish(result);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->response.status, ResponseStatus::kFailed);
  EXPECT_THAT(std::string(answer->response.message.view()), HasSubstr("arm: p_max_rad: "));
}

TEST_F(DriveRequestTest, TheSettingsOfADriveAreTold) {
  const auto outcome =
      desk.begin(linkRequest(100, toString(Operation::kDriveSettings), "arm"), {.connection = 1}, kAnyTime);
  ASSERT_TRUE(outcome.response);
  EXPECT_EQ(outcome.response->status, ResponseStatus::kOk);
  EXPECT_THAT(std::string(outcome.response->message.view()), HasSubstr("master_id 0 to 2046, whole\n"));
}

/// A Damiao arm and a wheel, simulated.
class ConfigureDriveTest : public ::testing::Test {
 protected:
  void ask(std::size_t motor = 0, double timeout_ms = 100.0) {
    Order order;
    order.id = ++asked_;
    order.operation = Operation::kConfigure;
    order.motors.set(motor);
    order.drive.count = 1;
    order.drive.save = true;
    order.drive.values[0] = {0, timeout_ms};  // timeout_ms
    ASSERT_TRUE(robot.exchange().orders.push(order));
  }
  OrderResult answer() {
    OrderResult result;
    for (int i = 0; i < 10'000; ++i) {
      robot.tick();
      if (robot.exchange().results.pop(result)) return result;
    }
    ADD_FAILURE() << "not answered";
    return result;
  }
  OrderResult configure(std::size_t motor = 0) {
    ask(motor);
    return answer();
  }

  VirtualRobot robot{
      robotOfText("robot: setup\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"
                  "      - {name: arm, model: DM4310, id: 1, master_id: 17, on_estop: brake}\n"
                  "      - {name: wheel, model: M3508, id: 2}\n")};

 private:
  std::uint64_t asked_ = 1000;
};

TEST_F(ConfigureDriveTest, IsDoneWhileTheMotorIsReady) {
  robot.run(100);
  const auto result = configure();
  EXPECT_FALSE(result.refused);
  EXPECT_EQ(result.motors[0], Refusal::kNone);
  robot.run(100);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kReady);
}

TEST_F(ConfigureDriveTest, IsRefusedWhileTheMotorIsActive) {
  robot.run(100);
  robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  EXPECT_EQ(configure().motors[0], Refusal::kActive);
}

TEST_F(ConfigureDriveTest, IsRefusedWhileTheMotorIsBraked) {
  robot.run(100);
  robot.order(Operation::kEnable);
  robot.order(Operation::kEstop);
  robot.run(10);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kReady);
  EXPECT_EQ(configure().motors[0], Refusal::kStillActs);
  robot.order(Operation::kDisable);
  EXPECT_EQ(configure().motors[0], Refusal::kNone);
}

TEST_F(ConfigureDriveTest, IsRefusedWhileTheDriveIsNotHeard) {
  robot.run(100);
  robot.simBus().silence(0, true);
  robot.run(100);
  EXPECT_EQ(configure().motors[0], Refusal::kOffline);
}

TEST_F(ConfigureDriveTest, TheMotorIsNotEnabledMeanwhile) {
  robot.run(100);
  ask();
  robot.tick();
  EXPECT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kConfiguring);
  EXPECT_EQ(answer().motors[0], Refusal::kNone);
}

TEST_F(ConfigureDriveTest, OneDriveIsConfiguredAtATime) {
  robot.run(100);
  ask();
  robot.tick();
  ask();
  EXPECT_EQ(answer().motors[0], Refusal::kConfiguring);
  EXPECT_EQ(answer().motors[0], Refusal::kNone);
}

TEST_F(ConfigureDriveTest, ADriveThatFallsSilentIsToldNotToHaveConfirmed) {
  robot.run(100);
  ask();
  robot.tick();
  robot.simBus().silence(0, true);
  EXPECT_EQ(answer().motors[0], Refusal::kNotConfirmed);
  robot.simBus().silence(0, false);
  robot.run(100);
  EXPECT_EQ(configure().motors[0], Refusal::kNone) << "and can be tried again";
}

TEST_F(ConfigureDriveTest, ADriveWithoutSettingsIsRefused) {
  robot.run(100);
  EXPECT_TRUE(configure(1).refused);
}

}  // namespace
}  // namespace rc10::test::drive_request_test
