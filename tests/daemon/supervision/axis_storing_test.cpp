// A drive that stores settings may be silent meanwhile, because it writes its flash or is sent nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "config/motor_families.hpp"
#include "daemon/robot_of_text.hpp"
#include "daemon/supervision/one_motor.hpp"
#include "motor/drive_configuring.hpp"

namespace rc10::test::axis_storing_test {
namespace {

using std::chrono::milliseconds;

[[nodiscard]] DriveWrite timeoutOf500Ms(const DriveSetup& setup) {
  const auto& settings = setup.settings;
  const auto found = std::find_if(settings.begin(), settings.end(),
                                  [](const DriveSetting& each) { return each.name == "timeout_ms"; });
  EXPECT_NE(found, settings.end());
  DriveWrite write;
  write.values[0] = {static_cast<std::uint8_t>(found - settings.begin()), 500.0};
  write.count = 1;
  write.save = true;
  return write;
}

/// One that can store a setting without becoming another drive, at rest.
class StoringDrive {
 public:
  explicit StoringDrive(const std::string& keys) {
    const auto outcome = OneMotor::parse(keys);
    EXPECT_TRUE(outcome.config) << outcome.errorText();
    config_ = outcome.config.value_or(twoWheelsAndYaw());
    robot = std::make_unique<VirtualRobot>(config_);
    for (int i = 0; i < 4000 && seen().status != MotorStatus::kReady; ++i) robot->tick();
    robot->run(100);
    EXPECT_EQ(seen().status, MotorStatus::kReady);
    EXPECT_TRUE(seen().feedback.zeroed);
    (void)robot->events();
  }

  void begin() {
    Order order;
    order.id = 77;
    order.operation = Operation::kConfigure;
    order.motors.set(0);
    order.drive = timeoutOf500Ms(setup());
    ASSERT_TRUE(robot->exchange().orders.push(order));
  }
  [[nodiscard]] const DriveSetup& setup() const { return *config_.buses[0].motors[0].traits().setup; }
  bool answered() { return robot->exchange().results.pop(result); }
  [[nodiscard]] DriveConfiguring& configuring() {
    return *robot->robot().motors()[0].motor->driveConfiguring();
  }
  /// Until its silence is excused.
  void tickUntilItStores() {
    for (int i = 0; i < 500 && !configuring().excusesSilence(); ++i) robot->tick();
    ASSERT_TRUE(configuring().excusesSilence());
  }
  const MotorSnapshot& seen() { return robot->motor(0); }
  [[nodiscard]] Duration age() { return robot->now() - seen().feedback.received; }

  std::unique_ptr<VirtualRobot> robot;
  OrderResult result;

 private:
  RobotConfig config_;
};

/// The first model of each family that has such a setting.
std::vector<std::string> storingDrives() {
  std::vector<std::string> found;
  for (const auto& entry : motorFamilies()) {
    for (const auto model : entry.family->models()) {
      std::string keys = "model: " + std::string{model} + ", id: 1, zero: power_on";
      if (entry.family->name() == "Damiao") keys += ", master_id: 17";
      const auto outcome = OneMotor::parse(keys);
      if (!outcome.config) continue;
      const auto* const setup = outcome.config->buses[0].motors[0].traits().setup;
      if (setup == nullptr || setup->settings.size() < 2) continue;  // a CyberGear has its id alone
      found.push_back(keys);
      break;
    }
  }
  return found;
}

class StoringDriveTest : public ::testing::TestWithParam<std::string> {};

TEST(StoringDrives, AreThoseOfEachFamilyWithSettings) {
  std::set<std::string> families;
  for (const auto& keys : storingDrives()) {
    const auto outcome = OneMotor::parse(keys);
    families.emplace(outcome.config->buses[0].motors[0].family->name());
  }
  EXPECT_EQ(families, (std::set<std::string>{"Damiao", "MyActuator", "RobStride"}));
}

/// A bus with an arm, whose drive stores; more of its motors may follow.
const std::string kLifter =
    "robot: lifter\nrealtime: preferred\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
    "      - {name: arm, model: DM4310, id: 1, master_id: 17}\n";

// While it stores its silence is no loss, so nothing of its group may rely on it.
TEST(StoringDrives, OfAGroupAreConfiguredOnlyWhileTheOthersRestAndKeepThemFromBeingEnabled) {
  VirtualRobot robot(robotOfText(kLifter + "      - {name: wheel, model: M3508, id: 2, on_disable: hold}\n"
                                           "groups: [{name: both, motors: [arm, wheel]}]\n"));
  robot.run(2000);
  const auto wheel = MotorSet{}.set(1);
  Order order;
  order.operation = Operation::kConfigure;
  order.motors.set(0);
  order.drive.values[0] = {0, 1.0};
  order.drive.count = 1;
  const auto configure = [&] {
    ++order.id;
    EXPECT_TRUE(robot.exchange().orders.push(order));
    robot.run(2);
    OrderResult result;
    return robot.exchange().results.pop(result) ? std::optional{result} : std::nullopt;
  };
  ASSERT_EQ(robot.orderFor(wheel, Operation::kEnable).motors[1], Refusal::kNone);
  for (const bool on : {true, false}) {
    if (!on) robot.orderFor(wheel, Operation::kDisable);
    ASSERT_EQ(robot.motor(1).acting, on ? Acting::kNothing : Acting::kHold);
    const auto refused = configure();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->motors[0], Refusal::kOthersOn);
    EXPECT_EQ(refused->in_the_way, wheel);
  }
  robot.orderFor(wheel, Operation::kDisable);
  EXPECT_FALSE(configure()) << "it has begun";
  for (const auto enable : {Operation::kEnable, Operation::kEnableAlone})
    EXPECT_EQ(robot.orderFor(wheel, enable).motors[1], Refusal::kConfiguring);
}

TEST(StoringDrives, DelayTheReturnOfTheirGroupAndDoNotPreventIt) {
  const auto config =
      robotOfText(kLifter +
                  "      - {name: left, model: M3508, id: 2}\n"
                  "  - {name: b, type: sim, motors: [{name: right, model: M3508, id: 2}]}\n"
                  "groups: [{name: all, motors: [arm, left, right], on_return: rearm_at_rest}]\n");
  VirtualRobot robot(config);
  robot.run(2000);
  const auto wheels = MotorSet{0b110};
  ASSERT_EQ(robot.orderFor(wheels, Operation::kEnable).motors[1], Refusal::kNone);
  robot.run(50);
  robot.freezeBus(1, true);
  robot.run(100);
  ASSERT_EQ(robot.motor(1).status, MotorStatus::kReady);
  auto& configuring = *robot.robot().motors()[0].motor->driveConfiguring();
  Order order;
  order.id = 77;
  order.operation = Operation::kConfigure;
  order.motors.set(0);
  order.drive = timeoutOf500Ms(*config.buses[0].motors[0].traits().setup);
  ASSERT_TRUE(robot.exchange().orders.push(order));
  for (int i = 0; i < 500 && !configuring.excusesSilence(); ++i) robot.tick();
  ASSERT_TRUE(configuring.excusesSilence());
  robot.freezeBus(1, false);
  robot.simBus(0).silence(0, true);  // it writes its flash
  robot.run(450);
  EXPECT_EQ(robot.motor(1).status, MotorStatus::kReady) << "at rest for longer than a group waits";
  robot.simBus(0).silence(0, false);
  OrderResult result;
  int ticks = 0;
  while (!robot.exchange().results.pop(result) && ticks < 9000) {
    robot.run(1);
    ++ticks;
  }
  ASSERT_LT(ticks, 9000);
  robot.run(400);
  EXPECT_EQ(robot.motor(1).status, MotorStatus::kActive);
  EXPECT_EQ(robot.motor(2).status, MotorStatus::kActive);
}

TEST_P(StoringDriveTest, StaysReadyWithItsReference) {
  StoringDrive drive{GetParam()};
  drive.begin();
  Duration oldest{};
  int ticks = 0;
  for (; ticks < 1000 && !drive.answered(); ++ticks) {
    drive.robot->tick();
    ASSERT_EQ(drive.seen().status, MotorStatus::kReady) << ticks;
    ASSERT_TRUE(drive.seen().feedback.zeroed) << ticks;
    oldest = std::max(oldest, drive.age());
  }
  ASSERT_LT(ticks, 1000);
  EXPECT_EQ(drive.result.motors[0], Refusal::kNone);
  if (!drive.setup().stores_at_once) {
    EXPECT_GE(oldest, milliseconds{50}) << "the simulated drive is silent while it stores";
  }
  EXPECT_TRUE(drive.robot->events().empty());
}

TEST_P(StoringDriveTest, StaysReadyWhenItsAnswerIsLost) {
  StoringDrive drive{GetParam()};
  drive.begin();
  drive.tickUntilItStores();
  drive.robot->simBus().silence(0, true);
  for (int i = 0; i < 60; ++i) {
    drive.robot->tick();
    ASSERT_EQ(drive.seen().status, MotorStatus::kReady) << i;
  }
  drive.robot->simBus().silence(0, false);
  int ticks = 0;
  for (; ticks < 2000 && !drive.answered(); ++ticks) {
    drive.robot->tick();
    ASSERT_EQ(drive.seen().status, MotorStatus::kReady) << ticks;
    ASSERT_TRUE(drive.seen().feedback.zeroed) << ticks;
  }
  EXPECT_EQ(drive.result.motors[0], Refusal::kNone);
}

TEST_P(StoringDriveTest, IsLostSoonIfItNeverAnswersAgain) {
  StoringDrive drive{GetParam()};
  drive.begin();
  drive.tickUntilItStores();
  drive.robot->simBus().silence(0, true);
  int ticks = 0;
  for (; ticks < 2000 && drive.seen().status == MotorStatus::kReady; ++ticks) drive.robot->tick();
  EXPECT_EQ(drive.seen().status, MotorStatus::kOffline);
  EXPECT_LE(ticks, 640);
  for (int i = 0; i < 2000 && !drive.answered(); ++i) drive.robot->tick();
  EXPECT_NE(drive.result.motors[0], Refusal::kNone);
  drive.robot->simBus().silence(0, false);
  drive.robot->run(50);
  EXPECT_EQ(drive.seen().status, MotorStatus::kReady);
}

// The supervisor refuses to enable it meanwhile.
TEST_P(StoringDriveTest, IsLostAsEverOnceItIsOn) {
  StoringDrive drive{GetParam()};
  drive.configuring().begin(timeoutOf500Ms(drive.setup()));
  drive.tickUntilItStores();
  drive.robot->beginEnabling(MotorSet{1});
  drive.robot->tick();
  ASSERT_EQ(drive.seen().status, MotorStatus::kEnabling);
  ASSERT_TRUE(drive.configuring().excusesSilence());
  drive.robot->simBus().silence(0, true);
  drive.robot->run(25);
  EXPECT_EQ(drive.seen().status, MotorStatus::kOffline);
}

INSTANTIATE_TEST_SUITE_P(All, StoringDriveTest, ::testing::ValuesIn(storingDrives()));

}  // namespace
}  // namespace rc10::test::axis_storing_test
