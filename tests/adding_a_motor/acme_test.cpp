// The worked example of docs/adding-a-motor.md, as a program that embeds rc10d uses it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "acme_drive.hpp"
#include "acme_loop_motor.hpp"
#include "acme_motor.hpp"
#include "config/load_config.hpp"
#include "config/motor_families.hpp"
#include "daemon/virtual_robot.hpp"
#include "sim/solo_rig.hpp"

namespace acme::acme_test {
namespace {

using namespace rc10;
using namespace std::chrono_literals;
using rc10::test::SoloRig;
using rc10::test::VirtualRobot;
using ::testing::HasSubstr;

// Before the first configuration, as a main() would.
const bool kAdded = addMotorFamily({&acmeFamily(), makeAcmeDrive}).has_value();

MotorSettings turner(int direction = 1) {
  MotorSettings settings;
  settings.name = "table";
  settings.model = "Turner";
  settings.id = 3;
  settings.direction = direction;
  return settings;
}

SoloRig rig(const MotorSettings& settings) {
  const auto traits = acmeFamily().traits(settings.model, settings.own);
  return {std::make_unique<ACME_Motor>(settings, traits), makeAcmeDrive(settings, {})};
}

CanFrame feedback(std::array<std::uint8_t, 8> bytes) { return makeClassicFrame({0x383, false}, bytes); }

TEST(Acme, DecodesFeedbackAtTheOutputShaft) {
  const auto settings = turner();
  ACME_Motor motor{settings, acmeFamily().traits(settings.model, settings.own)};
  // 3600.00 deg and 1000.0 rpm of the rotor, 42 C, enabled.
  ASSERT_EQ(motor.updateFeedback(feedback({0, 0, 0, 0, 0, 0, 42, 0})), FrameVerdict::kAccepted);
  ASSERT_EQ(motor.updateFeedback(feedback({0x40, 0x7E, 0x05, 0, 0x10, 0x27, 42, 1})),
            FrameVerdict::kAccepted);
  EXPECT_DOUBLE_EQ(motor.feedback().total_angle_deg, 360.0);
  EXPECT_FLOAT_EQ(motor.feedback().velocity_rpm, 100.0F);
  EXPECT_EQ(motor.feedback().temperature_c, 42.0F);
  EXPECT_EQ(motor.sequenceProgress(), SequenceProgress::kDone);
}

TEST(Acme, PacksACurrentWithinItsLimit) {
  for (const int direction : {1, -1}) {
    auto bench = rig(turner(direction));
    bench.command({.mode = ControlMode::kCurrent, .value = 100.0});
    bench.run(1ms);
    const auto sent = bench.takeSent();
    ASSERT_EQ(sent.size(), 1U);
    EXPECT_EQ(sent[0].id, (CanId{0x303, false}));
    EXPECT_EQ(sent[0].data[0], 1);
    const int milliamperes = static_cast<std::int16_t>(sent[0].data[2] | sent[0].data[3] << 8);
    EXPECT_EQ(milliamperes, direction * 20'000);
    EXPECT_NE(bench.motor().limits() & kLimitCurrent, 0U);
  }
}

TEST(Acme, RestIsOffWhateverTheOrderWas) {
  auto bench = rig(turner());
  bench.command({.mode = ControlMode::kVelocity, .value = 50.0});
  bench.run(1ms);
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  ASSERT_EQ(bench.motor().packRest(out), 1U);
  EXPECT_THAT(std::vector<std::uint8_t>(out[0].data.begin(), out[0].data.begin() + 8),
              ::testing::Each(std::uint8_t{0}));
}

TEST(Acme, IsCheckedLikeEveryOtherMotor) {
  ASSERT_TRUE(kAdded);
  const auto robot = [](const std::string& motors) {
    return parseRobotConfig("robot: acme\nbuses: [{name: b, type: sim, motors: [" + motors + "]}]\n",
                            "a.yaml");
  };
  EXPECT_TRUE(robot("{name: a, model: Turner, id: 1}"));
  EXPECT_THAT(robot("{name: a, model: Turner, id: 17}").errorText(),
              HasSubstr("above the highest Turner id 16"));
  EXPECT_THAT(robot("{name: a, model: Turner, id: 1, on_estop: hold}").errorText(), HasSubstr("cannot hold"));
  EXPECT_THAT(robot("{name: a, model: Turner, id: 1, velocity_pid: {}}").errorText(),
              HasSubstr("has loops of its own"));
  EXPECT_THAT(robot("{name: a, model: Turner, id: 1}, {name: b, model: Turner, id: 1}").errorText(),
              AllOf(HasSubstr("'a' (Turner id 1) and 'b' (Turner id 1) both answer with 0x381"),
                    HasSubstr("free for the Turner: 2, 3")));
}

class AcmeRobot : public ::testing::Test {
 protected:
  static constexpr std::size_t kTable = 0;
  MotorStatus status() { return robot.motor(kTable).status; }
  sim::Drive& drive() { return robot.simBus().drive(kTable); }

  VirtualRobot robot{
      loadRobotConfig(std::string{RC10_SOURCE_DIR} + "/examples/adding_a_motor/robot.yaml").config.value()};
};

TEST_F(AcmeRobot, IsEnabledTurnsAndIsAtRestAgain) {
  robot.run(20);
  EXPECT_EQ(status(), MotorStatus::kReady);
  EXPECT_FALSE(robot.order(Operation::kEnable).refused);
  EXPECT_EQ(status(), MotorStatus::kActive);
  robot.hold(kTable, {.mode = ControlMode::kVelocity, .value = 60.0}, 1000);
  EXPECT_NEAR(robot.motor(kTable).feedback.velocity_rpm, 60.0F, 1.0F);
  robot.order(Operation::kDisable);
  robot.run(2000);
  EXPECT_EQ(status(), MotorStatus::kReady);
  EXPECT_NEAR(robot.motor(kTable).feedback.velocity_rpm, 0.0F, 1.0F);
}

TEST_F(AcmeRobot, AFaultOfTheDriveIsAFaultUntilItIsCleared) {
  robot.run(20);
  robot.order(Operation::kEnable);
  drive().fault(2);
  robot.run(10);
  EXPECT_EQ(status(), MotorStatus::kFault);
  EXPECT_EQ(robot.motor(kTable).fault, FaultCode::kDriveTooHot);
  robot.order(Operation::kClear);
  robot.run(400);
  EXPECT_EQ(status(), MotorStatus::kReady);
  EXPECT_EQ(robot.motor(kTable).fault, FaultCode::kNone);
}

TEST_F(AcmeRobot, AFaultThatIsStillThereComesBackAfterAClear) {
  robot.run(20);
  robot.order(Operation::kEnable);
  for (int i = 0; i < 600; ++i) {
    drive().fault(1);
    if (i == 300) robot.order(Operation::kClear);
    robot.run(1);
  }
  EXPECT_EQ(status(), MotorStatus::kFault);
  EXPECT_EQ(robot.motor(kTable).fault, FaultCode::kDriveOverCurrent);
}

TEST_F(AcmeRobot, ADriveThatWasRestartedIsNotTrustedWithTheOldTarget) {
  robot.run(20);
  robot.order(Operation::kEnable);
  robot.hold(kTable, {.mode = ControlMode::kVelocity, .value = 60.0}, 500);
  robot.freezeBus(0, true);  // its power is away: it says nothing, and hears nothing
  robot.run(100);
  EXPECT_EQ(status(), MotorStatus::kOffline);
  robot.freezeBus(0, false);
  drive().restart();
  robot.run(200);
  EXPECT_EQ(status(), MotorStatus::kReady);
}

/// A Turner-C: its loops run on the host.
class AcmeLoops : public ::testing::Test {
 protected:
  static constexpr std::size_t kTable = 0;
  static RobotConfig configOf() {
    auto outcome = parseRobotConfig(
        "robot: acme\nbuses: [{name: b, type: sim, motors: [{name: table, model: Turner-C, id: 1, zero: "
        "power_on, "
        "feedback_timeout_ms: 50, velocity_limit_rpm: 200}]}]\n",
        "a.yaml");
    return std::move(outcome.config.value());
  }
  void SetUp() override {
    ASSERT_TRUE(kAdded);
    robot.run(20);
    ASSERT_FALSE(robot.order(Operation::kEnable).refused);
  }
  const MotorFeedback& feedback() { return robot.motor(kTable).feedback; }

  VirtualRobot robot{configOf()};
};

TEST_F(AcmeLoops, HoldAVelocity) {
  robot.hold(kTable, {.mode = ControlMode::kVelocity, .value = 60.0}, 1500);
  EXPECT_NEAR(feedback().velocity_rpm, 60.0F, 1.0F);
}

TEST_F(AcmeLoops, ReachAnAngleWithoutPassingIt) {
  double farthest_deg = 0.0;
  for (int i = 0; i < 20; ++i) {
    robot.hold(kTable, {.mode = ControlMode::kTotalAngle, .value = 90.0}, 100);
    farthest_deg = std::max(farthest_deg, feedback().total_angle_deg);
  }
  EXPECT_NEAR(feedback().total_angle_deg, 90.0, 0.5);
  EXPECT_LT(farthest_deg, 95.0);
}

MotorSettings turnerC() {
  MotorSettings settings = turner();
  settings.model = "Turner-C";
  settings.loops = *acmeFamily().traits(settings.model, {}).host_loops;
  return settings;
}

TEST_F(AcmeLoops, GiveNoCurrentOnOldFeedback) {
  const auto settings = turnerC();
  const auto traits = acmeFamily().traits(settings.model, {});
  SoloRig bench{std::make_unique<ACME_LoopMotor>(settings, traits), makeAcmeDrive(settings, {})};
  bench.command({.mode = ControlMode::kVelocity, .value = 100.0});
  bench.run(15ms);
  EXPECT_GT(bench.motor().commandValue(), 0.0F);
  bench.cut(true);
  bench.run(30ms);
  EXPECT_EQ(bench.motor().commandValue(), 0.0F);
}

TEST_F(AcmeLoops, TakeOtherGains) {
  const auto settings = turnerC();
  ACME_LoopMotor motor{settings, acmeFamily().traits(settings.model, {})};
  CascadeConfig loops = *motor.hostLoops();
  loops.angle.kp *= 2.0F;
  motor.retune(loops);
  EXPECT_EQ(motor.hostLoops()->angle.kp, loops.angle.kp);
}

}  // namespace
}  // namespace acme::acme_test
