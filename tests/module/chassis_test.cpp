#include "module/chassis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "app/planar_motion.hpp"
#include "fake_robot.hpp"
#include "module/chassis_values.hpp"
#include "module/swerve_chassis.hpp"

namespace rc10::test::chassis_test {
namespace {

enum Output : std::size_t { kX, kY, kHeading, kVx, kVy, kWz, kPower, kFactor };

struct Inputs {
  double vx_m_s = kNoSignal;
  double vy_m_s = kNoSignal;
  double wz_deg_s = kNoSignal;
  double frame = kNoSignal;
  double follow = kNoSignal;
  double x_m = kNoSignal;
  double y_m = kNoSignal;
  double heading_deg = kNoSignal;
};

class Sensor : public Module_Base {
 public:
  Sensor() : Module_Base({.inputs = {}, .outputs = {"yaw_deg", "relative_yaw_deg"}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
};

/// A gimbal that says when it may be turned after.
class GimbalModule : public Module_Base {
 public:
  GimbalModule()
      : Module_Base({.inputs = {}, .outputs = {"relative_yaw_deg", "turn_after_deg"}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
};

/// A chassis on motors that do at once what they are told.
class Chassis : public ::testing::Test {
 protected:
  void build(const ModuleType& type, OwnValues own) {
    ModuleSettings settings;
    settings.name = "base";
    settings.own = std::move(own);
    module_ = std::move(type.build(settings, outlineOf(8)).value());
    const Sensor imu;
    const GimbalModule head;
    ASSERT_TRUE(module_->connect(ModuleDirectory{{{"imu", &imu}, {"head", &head}}}).has_value());
  }
  void buildMecanum() { buildMecanum(common()); }
  void buildMecanum(OwnValues own) {
    own.set("wheels", std::vector{section({"front_left", "front_right", "rear_left", "rear_right"})});
    build(mecanumChassisType(), std::move(own));
  }
  void buildSwerve() {
    auto own = common();
    own.set("drive", std::vector{section({"front_left", "front_right", "rear_left", "rear_right"})});
    own.set("steer", std::vector{section({"front_left", "front_right", "rear_left", "rear_right"}, 4)});
    build(swerveChassisType(), own);
  }

  void give(const Inputs& in) {
    module_->setInputs(
        std::array{in.vx_m_s, in.vy_m_s, in.wz_deg_s, in.frame, in.follow, in.x_m, in.y_m, in.heading_deg});
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      robot_->update(*module_);
      for (auto& motor : robot_->motors()) obey(motor);
    }
  }
  static void obey(FakeRobot::Motor& motor) {
    auto& feedback = motor.feedback;
    const bool steers = motor.target && motor.target->mode == ControlMode::kAngle;
    if (steers) {
      feedback.total_angle_deg += std::remainder(motor.target->value - feedback.total_angle_deg, 360.0);
      feedback.angle_deg = static_cast<float>(motor.target->value);
    } else {
      const double rpm = motor.target ? motor.target->value : 0.0;
      feedback.velocity_rpm = static_cast<float>(rpm);
      feedback.total_angle_deg += rpm * 0.006;
    }
  }
  double target(std::size_t motor) { return robot_->motor(motor).target->value; }
  double output(Output output) { return module_->outputs()[output]; }
  double speed() { return std::hypot(output(kVx), output(kVy)); }

  /// A square of 1 m, a metre in each direction of `frame`, and back to rest.
  void driveSquare(double frame) {
    double farthest_m = 0.0;
    for (const auto& [vx, vy] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
      give({.vx_m_s = vx, .vy_m_s = vy, .wz_deg_s = 0.0, .frame = frame});
      run(1000);
      give({});
      run(300);
      farthest_m = std::max(farthest_m, std::hypot(output(kX), output(kY)));
    }
    // At the corner, with the way that acceleration costs.
    EXPECT_NEAR(farthest_m, std::hypot(1.0, 1.0), 0.4);
  }

  std::unique_ptr<FakeRobot> robot_ = std::make_unique<FakeRobot>(8);
  std::unique_ptr<Module_Base> module_;
};

TEST_F(Chassis, MecanumWheelsAreDrivenByTheirNames) {
  buildMecanum();
  give({.vx_m_s = 0.5});
  run(1000);
  const double rpm = 0.5 / (2.0 * std::numbers::pi * 0.076) * 60.0;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(target(i), rpm, 1e-6);
  give({.vy_m_s = 0.5});
  run(1000);
  EXPECT_NEAR(target(0), -rpm, 1e-6) << "front left, towards the left";
  EXPECT_NEAR(target(1), rpm, 1e-6);
  EXPECT_NEAR(target(2), rpm, 1e-6);
  EXPECT_NEAR(target(3), -rpm, 1e-6);
}

TEST_F(Chassis, OdometryReturnsToTheStartOfASquare) {
  buildMecanum();
  driveSquare(0.0);
  EXPECT_NEAR(output(kX), 0.0, 1e-9);
  EXPECT_NEAR(output(kY), 0.0, 1e-9);
}

TEST_F(Chassis, AccelerationIsLimitedAsAVector) {
  buildMecanum();
  give({.vx_m_s = 1.0, .vy_m_s = 1.0});
  double last = 0.0;
  for (int i = 0; i < 500; ++i) {
    run(1);
    EXPECT_LE(speed() - last, 0.004 + 1e-6);
    last = speed();
  }
  EXPECT_NEAR(output(kVx), output(kVy), 1e-6);
}

TEST_F(Chassis, SpeedIsLimitedInEveryDirectionAndTurningForItself) {
  buildMecanum();
  give({.vx_m_s = 30.0, .vy_m_s = 40.0, .wz_deg_s = 0.0});
  run(3000);
  EXPECT_NEAR(speed(), 2.0, 1e-6);
  EXPECT_NEAR(output(kVy) / output(kVx), 4.0 / 3.0, 1e-6);
}

TEST_F(Chassis, NoWheelIsToldMoreThanItsLimitAndTheDirectionIsKept) {
  auto own = common();
  own.set("wheel_limit_rpm", 100.0);
  buildMecanum(own);
  give({.vx_m_s = 1.0, .vy_m_s = 0.5, .wz_deg_s = 90.0});
  run(3000);
  double fastest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) fastest = std::max(fastest, std::fabs(target(i)));
  EXPECT_NEAR(fastest, 100.0, 1e-6);
  EXPECT_NEAR(output(kVy) / output(kVx), 0.5, 1e-6);
  EXPECT_NEAR(output(kWz) / output(kVx), 90.0, 1e-4);
}

TEST_F(Chassis, AWheelLimitBeyondThatOfAMotorDoesNotBendTheWay) {
  auto own = common();
  own.set("wheel_limit_rpm", 1000.0);  // of motors of 400 rpm
  own.set("max_speed_m_s", 20.0);
  buildMecanum(own);
  give({.vx_m_s = 30.0, .vy_m_s = 15.0, .wz_deg_s = 0.0});
  run(3000);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LE(std::fabs(target(i)), 400.0 + 1e-6);
  EXPECT_NEAR(std::fabs(target(0) / target(1)), 1.0 / 3.0, 1e-6);
}

TEST_F(Chassis, InReducedModeTheDirectionIsKept) {
  buildMecanum();
  robot_->motor(2).speed_ceiling_rpm = 10.0;
  give({.vx_m_s = 1.0, .vy_m_s = 0.5, .wz_deg_s = 0.0});
  run(3000);
  double fastest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) fastest = std::max(fastest, std::fabs(target(i)));
  EXPECT_NEAR(fastest, 10.0, 1e-6);
  EXPECT_NEAR(std::fabs(target(0) / target(1)), 1.0 / 3.0, 1e-6);
}

TEST_F(Chassis, InTheFrameOfTheWorldItKeepsItsDirectionWhileItTurns) {
  buildMecanum();
  give({.vx_m_s = 0.5, .wz_deg_s = 90.0, .frame = 1.0});
  run(4000);
  EXPECT_NEAR(output(kY), 0.0, 0.02) << "straight along x";
  EXPECT_GT(output(kX), 1.8);
}

TEST_F(Chassis, TheHeadingOfAnImuIsBelieved) {
  auto own = common();
  own.set("heading", std::string{"imu.yaw_deg"});
  buildMecanum(own);
  robot_->setOutput({.module = 0, .signal = 0}, 90.0);
  run(1);
  give({.vx_m_s = 0.5, .frame = 1.0});
  run(1000);
  EXPECT_NEAR(output(kHeading), 90.0, 1e-6);
  EXPECT_NEAR(output(kVy), -0.5, 1e-6) << "the world's x is to its right";
}

/// A chassis whose sensor tells the turning of its wheels, 7 ms late, times a sign.
class HeadingSensor : public Chassis {
 protected:
  void turn(double sign, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      // Its wheels roll without slip: a metre of way per radian at half of track and wheelbase.
      const double rolled_deg = robot_->motor(1).feedback.total_angle_deg;
      past_.insert(past_.begin(), sign * rolled_deg * 0.076 / ((0.5 + 0.4) / 2.0));
      if (past_.size() > 8) past_.pop_back();
      robot_->setOutput({.module = 0, .signal = 0}, std::remainder(past_.back() + pushed_deg_, 360.0));
      run(1);
      events_.insert(events_.end(), robot_->events().begin(), robot_->events().end());
    }
  }
  void buildWithHeading() {
    auto own = common();
    own.set("heading", std::string{"imu.yaw_deg"});
    buildMecanum(own);
  }
  std::vector<double> past_;
  std::vector<std::size_t> events_;
  double pushed_deg_ = 0.0;
};

TEST_F(HeadingSensor, ThatTurnsAgainstTheWheelsIsToldAndNotUsed) {
  buildWithHeading();
  turn(-1.0, 100);
  give({.wz_deg_s = 90.0});
  turn(-1.0, 1000);
  EXPECT_THAT(events_, ::testing::ElementsAre(0U));
  EXPECT_GT(output(kHeading), 70.0) << "by the wheels";
}

TEST_F(HeadingSensor, ThatTurnsWithThemIsUsedWhateverPushesTheRobot) {
  buildWithHeading();
  give({.wz_deg_s = 90.0});
  for (int i = 0; i < 40; ++i) {
    pushed_deg_ += i % 3 == 0 ? 5.0 : -3.0;
    give({.wz_deg_s = i % 2 == 0 ? 90.0 : -60.0});
    turn(1.0, 200);
  }
  EXPECT_TRUE(events_.empty());
  EXPECT_NEAR(std::remainder(output(kHeading) - past_.back() - pushed_deg_, 360.0), 0.0, 2.0);
}

TEST_F(HeadingSensor, ThatWasMountedAnewWhileTheMotorsWereDisabledIsComparedAgain) {
  buildWithHeading();
  give({.wz_deg_s = 90.0});
  turn(1.0, 1000);
  ASSERT_TRUE(events_.empty());
  for (auto& motor : robot_->motors()) motor.status = MotorStatus::kReady;
  turn(1.0, 10);
  turn(-1.0, 10);
  for (auto& motor : robot_->motors()) motor.status = MotorStatus::kActive;
  turn(-1.0, 1000);
  EXPECT_THAT(events_, ::testing::ElementsAre(0U));
  for (auto& motor : robot_->motors()) motor.status = MotorStatus::kReady;
  turn(-1.0, 10);
  for (auto& motor : robot_->motors()) motor.status = MotorStatus::kActive;
  const double heading_deg = output(kHeading);
  turn(-1.0, 10);
  EXPECT_NEAR(output(kHeading), heading_deg, 2.0) << "one of the wrong sign stays out";
}

TEST_F(HeadingSensor, ThatStandsWhileTheWheelsSlipIsNoWrongSign) {
  buildWithHeading();
  give({.wz_deg_s = 90.0});
  turn(0.0, 3000);
  EXPECT_TRUE(events_.empty());
}

TEST_F(Chassis, FollowsTheGimbalAndDrivesWhereItLooks) {
  auto own = common();
  own.set("follow", std::string{"imu.relative_yaw_deg"});
  buildMecanum(own);
  robot_->setOutput({.module = 0, .signal = 1}, 30.0);
  give({.vx_m_s = 1.0, .frame = 2.0, .follow = 1.0});
  run(1000);
  EXPECT_NEAR(output(kVx), std::cos(30.0 * std::numbers::pi / 180.0), 1e-3);
  EXPECT_NEAR(output(kVy), std::sin(30.0 * std::numbers::pi / 180.0), 1e-3);
  EXPECT_NEAR(output(kWz), 150.0, 1e-3);
  robot_->setOutput({.module = 0, .signal = 1}, kNoSignal);
  run(2000);
  EXPECT_NEAR(speed(), 0.0, 1e-9) << "nobody knows where the gimbal looks";
}

TEST_F(Chassis, TurnsAfterAGimbalOnlyWhileThatBringsItNearer) {
  auto own = common();
  own.set("follow", std::string{"head.relative_yaw_deg"});
  buildMecanum(own);
  robot_->setOutput({.module = 1, .signal = 0}, 30.0);
  robot_->setOutput({.module = 1, .signal = 1}, kNoSignal);
  give({.vx_m_s = 1.0, .frame = 2.0, .follow = 1.0});
  run(1000);
  EXPECT_NEAR(output(kWz), 0.0, 1e-9);
  EXPECT_NEAR(speed(), 1.0, 1e-3) << "it still drives where the gimbal looks";
  robot_->setOutput({.module = 1, .signal = 1}, 30.0);
  run(1000);
  EXPECT_NEAR(output(kWz), 150.0, 1e-3);
}

TEST_F(Chassis, OneWheelThatIsNotThereStopsThemAll) {
  buildMecanum();
  give({.vx_m_s = 1.0});
  run(100);
  for (std::size_t i = 0; i < 4; ++i) ASSERT_TRUE(robot_->motor(i).target.has_value());
  robot_->motor(2).status = MotorStatus::kFault;
  run(1);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FALSE(robot_->motor(i).target.has_value());
}

TEST_F(Chassis, SilenceLeavesTheWheelsToTheirFallbacks) {
  buildMecanum();
  give({.vx_m_s = 1.0});
  run(100);
  ASSERT_TRUE(robot_->motor(0).target.has_value());
  module_->clearInputs();
  run(1);
  EXPECT_FALSE(robot_->motor(0).target.has_value());
}

TEST_F(Chassis, ACommandGoesOnFromHowItRolls) {
  buildMecanum();
  run(2);
  const double rolls_rpm = 0.4 / (2.0 * std::numbers::pi * 0.076) * 60.0;
  for (std::size_t i = 0; i < 4; ++i) robot_->motor(i).feedback.velocity_rpm = static_cast<float>(rolls_rpm);
  robot_->update(*module_);
  give({.vx_m_s = 0.4});
  robot_->update(*module_);
  EXPECT_NEAR(target(0), rolls_rpm, 0.01);
}

TEST_F(Chassis, ACommandAfterAPauseWaitsUntilItIsHeardHowItRolls) {
  buildMecanum();
  run(2);
  const double rolls_rpm = 0.4 / (2.0 * std::numbers::pi * 0.076) * 60.0;
  for (std::size_t i = 0; i < 4; ++i) {
    robot_->motor(i).feedback.velocity_rpm = static_cast<float>(rolls_rpm);
    robot_->motor(i).heard = false;
  }
  robot_->pause(std::chrono::milliseconds{150});
  robot_->update(*module_);
  give({.vx_m_s = 0.4});
  for (int i = 0; i < 3; ++i) robot_->update(*module_);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(robot_->motor(i).target.has_value()) << "told nothing that would brake it";
    robot_->motor(i).heard = true;
  }
  robot_->update(*module_);
  EXPECT_NEAR(target(0), rolls_rpm, 0.01);
}

TEST_F(Chassis, ThePoseCanBeSet) {
  buildMecanum();
  give({.x_m = 3.0, .y_m = -1.0, .heading_deg = 45.0});
  run(1);
  EXPECT_EQ(output(kX), 3.0);
  EXPECT_EQ(output(kY), -1.0);
  EXPECT_NEAR(output(kHeading), 45.0, 1e-9);
}

// Way of a mecanum chassis by its wheels and by its odometry, when samples come only
// every few ticks, of each wheel in another one, and some are lost.
class LossyChassis : public Chassis {
 protected:
  double lost(int every, double lost_share) {
    robot_ = std::make_unique<FakeRobot>(8);
    buildMecanum();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::array<double, 4> true_deg{};
    for (int tick = 0; tick < 4000; ++tick) {
      give({.vx_m_s = tick < 3500 ? 2.0 : 0.0});
      for (std::size_t i = 0; i < 4; ++i) {
        auto& motor = robot_->motor(i);
        const double rpm = motor.target ? motor.target->value : 0.0;
        true_deg[i] += rpm * 0.006;
        motor.heard = (tick + static_cast<int>(i)) % every == 0 && share(random) >= lost_share;
        if (!motor.heard) continue;
        motor.feedback.velocity_rpm = static_cast<float>(rpm);
        motor.feedback.total_angle_deg = true_deg[i];
      }
      robot_->update(*module_);
    }
    const double true_m = true_deg[0] / 360.0 * 2.0 * std::numbers::pi * 0.076;
    return std::fabs(output(kX) / true_m - 1.0);
  }
};

TEST_F(LossyChassis, LosesNoWayOverGapsOfFeedback) {
  for (const int every : {1, 2, 3, 5, 10}) {
    for (const double lost_share : {0.0, 0.03, 0.2}) {
      EXPECT_LT(lost(every, lost_share), 1e-3) << "every " << every << " ticks, " << lost_share << " lost";
    }
  }
}

TEST_F(LossyChassis, TheWayOfTheOthersWaitsForAWheelThatIsNotHeard) {
  buildMecanum();
  give({.vx_m_s = 1.0});
  run(3000);
  const double before_m = output(kX);
  robot_->motor(3).heard = false;
  const double unheard_deg = robot_->motor(3).feedback.total_angle_deg;
  double true_deg = unheard_deg;
  for (int tick = 0; tick < 400; ++tick) {
    run(1);
    true_deg = robot_->motor(3).feedback.total_angle_deg;
    if (tick == 200) {
      EXPECT_LT(output(kX), before_m + 0.2) << "waits, as soon as it is not fresh";
    }
  }
  robot_->motor(3).heard = true;
  robot_->motor(3).feedback.total_angle_deg = true_deg;
  run(1);
  EXPECT_NEAR(output(kX) - before_m, 0.4, 0.01);
}

TEST_F(Chassis, AnAngleThatJumpsIsNoWay) {
  buildMecanum();
  run(2);
  for (std::size_t i = 0; i < 4; ++i) robot_->motor(i).feedback.total_angle_deg = 100'000.0;
  run(1);
  EXPECT_EQ(output(kX), 0.0);
  for (std::size_t i = 0; i < 4; ++i) robot_->motor(i).feedback.total_angle_deg = kNoSignal;
  run(2);
  EXPECT_EQ(output(kX), 0.0);
}

TEST_F(Chassis, AtTheEndOfAFieldOfAnglesTheSpeedTellsTheWay) {
  buildMecanum();
  run(1);
  give({.vx_m_s = 0.5});
  run(1000);
  const double before_m = output(kX);
  for (int i = 0; i < 1000; ++i) {
    for (auto& motor : robot_->motors()) {
      motor.feedback.angle_at_end = true;
      motor.feedback.total_angle_deg = 3200.0;
    }
    run(1);
  }
  EXPECT_NEAR(output(kX) - before_m, 0.5, 0.01);
}

TEST_F(Chassis, AFrameThatIsNoNumberOfOneIsTheRobots) {
  buildMecanum();
  for (const double frame : {1e20, -1e20, 0.5, 3.0}) {
    give({.vx_m_s = 0.1, .frame = frame, .heading_deg = 90.0});
    run(100);
    EXPECT_NEAR(output(kVx), 0.1, 1e-3) << frame;
  }
}

TEST_F(Chassis, OldFeedbackSaysNothing) {
  buildMecanum();
  run(2);
  EXPECT_EQ(output(kVx), 0.0);
  robot_->motor(3).feedback.samples = 0;
  robot_->update(*module_);
  robot_->motor(3).feedback.samples = 0;
  class Stale : public FakeRobot {
   public:
    Stale() : FakeRobot(8) {}
    [[nodiscard]] const MotorFeedback& feedback(std::size_t) const noexcept override { return never_; }

   private:
    MotorFeedback never_;
  } stale;
  stale.update(*module_);
  EXPECT_TRUE(std::isnan(output(kVx)));
  EXPECT_FALSE(std::isnan(output(kX))) << "where it was last";
}

TEST_F(Chassis, Omni3TurnsOnTheSpotWithAllWheelsAlike) {
  auto own = common();
  own.set("wheels", std::vector{section({"left", "right", "middle"})});
  build(omni3ChassisType(), own);
  give({.wz_deg_s = 90.0});
  run(1000);
  EXPECT_NEAR(target(0), target(1), 1e-9);
  EXPECT_NEAR(target(0), target(2), 1e-9);
  EXPECT_NEAR(output(kWz), 90.0, 1e-4);
  EXPECT_NEAR(output(kHeading), 90.0 * 0.9375, 0.2) << "an eighth of a second to get there";
}

TEST_F(Chassis, Omni4DrivesASquare) {
  auto own = common();
  own.set("wheels", std::vector{section({"front_left", "front_right", "rear_left", "rear_right"})});
  build(omni4ChassisType(), own);
  driveSquare(0.0);
  EXPECT_NEAR(output(kX), 0.0, 1e-9);
  EXPECT_NEAR(output(kY), 0.0, 1e-9);
}

TEST_F(Chassis, SidewaysIsNothingToADifferentialChassisAndItsBounds) {
  auto own = common();
  own.set("wheels", std::vector{section({"left", "right"})});
  build(differentialChassisType(), std::move(own));
  give({.vx_m_s = 2.0, .vy_m_s = 2.0});
  run(2000);
  EXPECT_NEAR(output(kVx), 2.0, 1e-3);
}

TEST_F(Chassis, DifferentialDrivesForwardAndTurnsButNotSideways) {
  auto own = common();
  own.set("wheels", std::vector{section({"left", "right"})});
  build(differentialChassisType(), own);
  give({.vx_m_s = 0.5, .vy_m_s = 0.5, .wz_deg_s = 30.0});
  run(1000);
  EXPECT_NEAR(output(kVx), 0.5, 1e-6);
  EXPECT_EQ(output(kVy), 0.0);
  EXPECT_NEAR(output(kWz), 30.0, 1e-4);
  EXPECT_GT(target(1), target(0));
}

TEST_F(Chassis, SwerveSteersBeforeItDrivesAndDrivesASquare) {
  buildSwerve();
  give({.vy_m_s = 1.0});
  run(1);
  EXPECT_NEAR(std::fabs(std::remainder(target(4) - 90.0, 180.0)), 0.0, 1e-6)
      << "towards the left, or backwards";
  EXPECT_NEAR(target(0), 0.0, 1e-6) << "it still points forward";
  run(500);
  EXPECT_NEAR(output(kVy), 1.0, 1e-6);
  module_->clearInputs();
  run(2);
  give({.x_m = 0.0, .y_m = 0.0, .heading_deg = 0.0});
  run(1);
  driveSquare(0.0);
  EXPECT_NEAR(output(kX), 0.0, 0.01);
  EXPECT_NEAR(output(kY), 0.0, 0.01);
}

TEST_F(Chassis, SwerveSlowsAllItsWheelsAlikeInReducedMode) {
  buildSwerve();
  give({.vx_m_s = 1.0, .wz_deg_s = 60.0});
  run(3000);
  std::array<double, 4> full{};
  for (std::size_t i = 0; i < 4; ++i) full[i] = target(i);
  robot_->motor(2).speed_ceiling_rpm = 10.0;
  run(3000);
  double fastest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) fastest = std::max(fastest, std::fabs(target(i)));
  EXPECT_NEAR(fastest, 10.0, 1e-6);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_NEAR(target(i) / target(0), full[i] / full[0], 1e-3) << i;
}

TEST_F(Chassis, SwerveDoesNotDriveWhileOneWheelDoesNotKnowItsDirection) {
  buildSwerve();
  robot_->motor(6).feedback.zeroed = false;
  give({.vx_m_s = 1.0});
  run(1);
  EXPECT_FALSE(robot_->motor(0).target.has_value());
  robot_->motor(6).feedback.zeroed = true;
  run(1);
  EXPECT_TRUE(robot_->motor(0).target.has_value());
}

}  // namespace
}  // namespace rc10::test::chassis_test
