#include "module/gimbal.hpp"

#include <array>
#include <cmath>

#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace rc10::test::gimbal_test {
namespace {

using ::testing::ElementsAre;

enum Output : std::size_t { kYaw, kPitch, kRelativeYaw, kTargetYaw, kTargetPitch, kStabilised };

class ImuModule : public Module_Base {
 public:
  ImuModule() : Module_Base({.inputs = {}, .outputs = {"yaw_deg", "yaw_rate_deg_s"}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
};

ModuleSettings settings(bool with_imu) {
  ModuleSettings settings;
  settings.name = "gimbal";
  auto& own = settings.own;
  own.set("yaw", 0.0);
  own.set("pitch", 1.0);
  own.set("pitch_min_deg", -20.0);
  own.set("pitch_max_deg", 30.0);
  own.set("gain_per_s", 10.0);
  own.set("velocity_limit_rpm", 60.0);
  own.set("silence_max_s", 10.0);
  if (with_imu) {
    own.set("imu_yaw", std::string{"imu.yaw_deg"});
    own.set("imu_yaw_rate", std::string{"imu.yaw_rate_deg_s"});
  }
  return settings;
}

/// A gimbal on a chassis that turns, with motors that do at once what they are told.
class Gimbal : public ::testing::Test {
 protected:
  void build(bool with_imu) {
    with_imu_ = with_imu;
    module_ = std::move(gimbalType().build(settings(with_imu), outlineOf(2)).value());
    const ImuModule imu;
    ASSERT_TRUE(module_->connect(ModuleDirectory{{{"imu", &imu}}}).has_value());
  }
  void aim(double yaw_deg, double pitch_deg) {
    module_->setInputs(std::array{yaw_deg, pitch_deg, kNoSignal, kNoSignal});
  }
  void turn(double yaw_rate_deg_s, double pitch_rate_deg_s) {
    module_->setInputs(std::array{kNoSignal, kNoSignal, yaw_rate_deg_s, pitch_rate_deg_s});
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      chassis_deg_ += chassis_deg_s_ * 0.001;
      const double world_deg = chassis_deg_ + robot_.motor(0).feedback.total_angle_deg;
      const double rate_deg_s =
          chassis_deg_s_ + static_cast<double>(robot_.motor(0).feedback.velocity_rpm) * 6.0;
      robot_.setOutput({.module = 0, .signal = 0}, imu_heard_ ? std::remainder(world_deg, 360.0) : kNoSignal);
      robot_.setOutput({.module = 0, .signal = 1}, imu_heard_ ? rate_deg_s : kNoSignal);
      robot_.update(*module_);
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
      for (auto& motor : robot_.motors()) obey(motor);
      worst_deg_ = std::max(worst_deg_, std::fabs(std::remainder(world() - held_deg_, 360.0)));
    }
  }
  static void obey(FakeRobot::Motor& motor) {
    const double rpm = motor.target ? motor.target->value : 0.0;
    motor.feedback.velocity_rpm = static_cast<float>(rpm);
    motor.feedback.total_angle_deg += rpm * 0.006;
    const double turn_deg = std::fmod(motor.feedback.total_angle_deg, 360.0);
    motor.feedback.angle_deg = static_cast<float>(turn_deg < 0.0 ? turn_deg + 360.0 : turn_deg);
  }
  double world() { return chassis_deg_ + robot_.motor(0).feedback.total_angle_deg; }
  double pitch() { return robot_.motor(1).feedback.total_angle_deg; }
  double output(Output output) { return module_->outputs()[output]; }

  FakeRobot robot_{2};
  std::unique_ptr<Module_Base> module_;
  std::vector<std::size_t> events_;
  bool with_imu_ = false;
  bool imu_heard_ = true;
  double chassis_deg_ = 0.0;
  double chassis_deg_s_ = 0.0;
  double held_deg_ = 0.0;
  double worst_deg_ = 0.0;
};

TEST_F(Gimbal, AimsAtAnAngleOfTheWorldAndWithinItsPitch) {
  build(true);
  aim(-170.0, 80.0);
  run(2000);
  EXPECT_NEAR(std::remainder(world() + 170.0, 360.0), 0.0, 0.1);
  EXPECT_NEAR(pitch(), 30.0, 0.1);
  EXPECT_EQ(output(kTargetPitch), 30.0);
}

TEST_F(Gimbal, HoldsItsDirectionWhileTheChassisTurnsUnderIt) {
  build(true);
  aim(45.0, 0.0);
  run(2000);
  held_deg_ = 45.0;
  worst_deg_ = 0.0;
  chassis_deg_s_ = 180.0;
  run(4000);
  EXPECT_LT(worst_deg_, 0.5);
  EXPECT_NEAR(std::remainder(output(kRelativeYaw) - (45.0 - chassis_deg_), 360.0), 0.0, 1.0);
}

TEST_F(Gimbal, TurnsAtTheRateThatItIsTold) {
  build(true);
  turn(90.0, 10.0);
  run(1000);
  EXPECT_NEAR(world(), 90.0, 2.0);
  EXPECT_NEAR(pitch(), 10.0, 1.0);
}

TEST_F(Gimbal, HoldsWhenItsClientFallsSilentButAsksNothingBeforeTheFirstCommand) {
  build(true);
  run(10);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  aim(30.0, 5.0);
  run(2000);
  module_->clearInputs();
  held_deg_ = world();
  worst_deg_ = 0.0;
  chassis_deg_s_ = 90.0;
  run(2000);
  EXPECT_LT(worst_deg_, 0.5);
}

TEST_F(Gimbal, ActsForNobodyNoLongerThanItsTime) {
  build(true);
  aim(30.0, 5.0);
  run(2000);
  module_->clearInputs();
  run(9'999);
  EXPECT_TRUE(robot_.motor(0).target.has_value());
  EXPECT_THAT(events_, ::testing::IsEmpty());
  run(2);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  EXPECT_FALSE(robot_.motor(1).target.has_value());
  EXPECT_THAT(events_, ElementsAre(2U)) << "told once";
  run(5000);
  EXPECT_THAT(events_, ElementsAre(2U));
  aim(30.0, 5.0);
  run(2);
  EXPECT_TRUE(robot_.motor(0).target.has_value()) << "a client brings it back";
}

TEST_F(Gimbal, WithoutItsSensorItHoldsToTheChassisAndNothingJumps) {
  build(true);
  chassis_deg_ = 100.0;
  aim(130.0, 0.0);
  run(2000);
  module_->clearInputs();
  imu_heard_ = false;
  held_deg_ = world();
  worst_deg_ = 0.0;
  run(500);
  EXPECT_LT(worst_deg_, 0.5);
  EXPECT_EQ(output(kStabilised), 0.0);
  imu_heard_ = true;
  run(500);
  EXPECT_LT(worst_deg_, 0.5);
  EXPECT_THAT(events_, ElementsAre(0U, 1U));
}

TEST_F(Gimbal, AfterItWasDisabledItLooksWhereItIs) {
  build(true);
  aim(90.0, 0.0);
  run(2000);
  robot_.motor(0).status = MotorStatus::kReady;
  module_->clearInputs();
  run(10);
  robot_.motor(0).feedback.total_angle_deg = 10.0;
  robot_.motor(0).status = MotorStatus::kActive;
  turn(0.0, 0.0);
  run(500);
  EXPECT_NEAR(world(), 10.0, 0.5);
}

TEST_F(Gimbal, WithoutAReferenceItDoesNotMove) {
  build(false);
  robot_.motor(0).feedback.zeroed = false;
  aim(90.0, 0.0);
  run(100);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST(GimbalType, RefusesOneMotorForBothAndLimitsTheWrongWayRound) {
  auto own = settings(false);
  own.own.set("pitch", 0.0);
  EXPECT_EQ(gimbalType().build(own, outlineOf(2)).error().message,
            "pitch: is the same motor as yaw; name another");
  own = settings(false);
  own.own.set("pitch_min_deg", 40.0);
  EXPECT_EQ(gimbalType().build(own, outlineOf(2)).error().message,
            "pitch_max_deg: must be above pitch_min_deg; change one of them");
}

}  // namespace
}  // namespace rc10::test::gimbal_test
