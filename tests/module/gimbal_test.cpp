#include "module/gimbal.hpp"

#include <array>
#include <cmath>
#include <deque>
#include <random>

#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace rc10::test::gimbal_test {
namespace {

using ::testing::ElementsAre;

enum Output : std::size_t {
  kYaw,
  kPitch,
  kRelativeYaw,
  kTargetYaw,
  kTargetPitch,
  kStabilised,
  kLagMs,
  kAgrees,
  kTurnAfter
};

class ImuModule : public Module_Base {
 public:
  ImuModule()
      : Module_Base({.inputs = {}, .outputs = {"yaw_deg", "yaw_rate_deg_s", "pitch_deg"}, .events = {}}) {}
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

TEST_F(Gimbal, BeginsWhereItLooksHoweverLongItWasIdle) {
  build(true);
  run(10);
  robot_.motor(1).feedback.angle_deg = 345.0F;  // sagged
  robot_.motor(1).feedback.total_angle_deg = -15.0;
  chassis_deg_s_ = 90.0;  // carried
  run(1000);
  chassis_deg_s_ = 0.0;
  run(200);
  held_deg_ = world();
  worst_deg_ = 0.0;
  turn(0.0, 0.0);
  run(1000);
  EXPECT_LT(worst_deg_, 0.5);
  EXPECT_NEAR(pitch(), -15.0, 0.5);
}

TEST_F(Gimbal, SaysWhenTheChassisMayTurnAfterIt) {
  build(true);
  aim(30.0, 0.0);
  run(1000);
  EXPECT_NEAR(output(kTurnAfter), 30.0, 0.5);
  imu_heard_ = false;
  run(10);
  EXPECT_TRUE(std::isnan(output(kTurnAfter))) << "it turns with the chassis";
  EXPECT_NEAR(output(kRelativeYaw), 30.0, 0.5);
  imu_heard_ = true;
  robot_.motor(0).status = MotorStatus::kReady;
  run(10);
  EXPECT_TRUE(std::isnan(output(kTurnAfter)));
  robot_.motor(0).status = MotorStatus::kOffline;
  run(10);
  EXPECT_TRUE(std::isnan(output(kRelativeYaw))) << "nobody sees it";
}

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

TEST_F(Gimbal, ARateBeyondAllReasonCountsToNoInfinity) {
  build(true);
  turn(1e300, -1e300);
  run(1000);
  EXPECT_NEAR(world(), 360.0, 10.0) << "as fast as it may";
  EXPECT_NEAR(pitch(), -20.0, 0.1);
  turn(0.0, 0.0);
  run(1000);
  const double stopped_deg = world();
  run(500);
  EXPECT_NEAR(world(), stopped_deg, 0.1);
  aim(30.0, 0.0);
  run(2000);
  EXPECT_NEAR(std::remainder(world() - 30.0, 360.0), 0.0, 0.1) << "and it can be aimed again";
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
  held_deg_ = world();
  worst_deg_ = 0.0;
  for (const bool aimed : {true, false}) {
    if (!aimed) module_->clearInputs();
    for (const bool heard : {false, true}) {
      imu_heard_ = heard;
      run(500);
      EXPECT_EQ(output(kStabilised), heard ? 1.0 : 0.0);
      EXPECT_LT(worst_deg_, 0.5) << aimed;
      EXPECT_NEAR(output(kYaw), 130.0, 0.5) << "for a client that aims from there";
      EXPECT_NEAR(output(kTargetYaw), 130.0, 0.5);
    }
  }
  EXPECT_THAT(events_, ElementsAre(0U, 1U, 0U, 1U));
}

TEST_F(Gimbal, WithoutItsSensorAnglesTurnWithTheChassisUntilItIsBack) {
  build(true);
  chassis_deg_ = 100.0;
  aim(130.0, 0.0);
  run(2000);
  imu_heard_ = false;
  run(10);
  chassis_deg_ = 140.0;
  run(500);
  EXPECT_NEAR(output(kRelativeYaw), 30.0, 0.5);
  aim(120.0, 0.0);
  run(1000);
  EXPECT_NEAR(output(kRelativeYaw), 20.0, 0.5);
  imu_heard_ = true;
  run(1000);
  EXPECT_NEAR(world(), 120.0, 0.5);
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
  robot_.motor(0).feedback.zeroed = true;
  run(2);
  EXPECT_TRUE(robot_.motor(0).target.has_value());
}

/// A gimbal whose motors take some time, with a gyro that is late, noisy and slower than the tick.
class LateGimbal : public ::testing::Test {
 protected:
  void findAnOpposedPitch() {
    pitch_sign_ = -1.0;
    build(7);
    run(300);
    aim(0.0, 5.0);
    run(1000);
  }
  struct Truth {
    double yaw_deg;
    double yaw_rate_deg_s;
    double pitch_deg;
  };
  void build(int lag_ticks, int imu_period = 1) {
    lag_ticks_ = lag_ticks;
    imu_period_ = imu_period;
    auto own = settings(true);
    own.own.set("imu_pitch", std::string{"imu.pitch_deg"});
    own.own.set("imu_yaw_reversed", yaw_reversed_key_ ? 1.0 : 0.0);
    own.own.set("imu_pitch_reversed", pitch_reversed_key_ ? 1.0 : 0.0);
    module_ = std::move(gimbalType().build(own, outlineOf(2)).value());
    const ImuModule imu;
    ASSERT_TRUE(module_->connect(ModuleDirectory{{{"imu", &imu}}}).has_value());
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      chassis_deg_ += chassis_deg_s_ * 0.001;
      past_.push_front({world(), chassis_deg_s_ + rpm_[0] * 6.0, chassis_pitch_deg_ + pitch()});
      if (past_.size() > 64) past_.pop_back();
      if (++tick_ % imu_period_ == 0) sense();
      robot_.update(*module_);
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
      for (std::size_t motor = 0; motor < 2; ++motor) obey(motor);
      const double off_deg = std::remainder(world() - held_deg_, 360.0);
      least_deg_ = std::min(least_deg_, off_deg);
      most_deg_ = std::max(most_deg_, off_deg);
    }
  }
  void sense() {
    const auto& seen = past_[std::min<std::size_t>(static_cast<std::size_t>(lag_ticks_), past_.size() - 1)];
    const auto put = [&](std::size_t signal, double value) {
      robot_.setOutput({.module = 0, .signal = signal}, value);
    };
    put(0, std::remainder(yaw_sign_ * seen.yaw_deg, 360.0));
    put(1, rate_sign_ * seen.yaw_rate_deg_s + noise_(random_));
    put(2, imu_heard_ ? pitch_sign_ * seen.pitch_deg + 0.1 * noise_(random_) : kNoSignal);
  }
  // The velocity loop of a light rotor.
  void obey(std::size_t index) {
    auto& motor = robot_.motor(index);
    const double wanted_rpm = motor.target ? motor.target->value : 0.0;
    rpm_[index] += (wanted_rpm - rpm_[index]) * 0.25;
    motor.feedback.velocity_rpm = static_cast<float>(rpm_[index]);
    motor.feedback.total_angle_deg += rpm_[index] * 0.006;
    const double turn_deg = std::fmod(motor.feedback.total_angle_deg, 360.0);
    motor.feedback.angle_deg = static_cast<float>(turn_deg < 0.0 ? turn_deg + 360.0 : turn_deg);
  }
  void aim(double yaw_deg, double pitch_deg) {
    module_->setInputs(std::array{yaw_deg, pitch_deg, kNoSignal, kNoSignal});
  }
  /// Peak to peak, from now on, of the yaw in the world.
  double swingOver(int ticks) {
    held_deg_ = world();
    least_deg_ = most_deg_ = 0.0;
    run(ticks);
    return most_deg_ - least_deg_;
  }
  double world() { return chassis_deg_ + robot_.motor(0).feedback.total_angle_deg; }
  double pitch() { return robot_.motor(1).feedback.total_angle_deg; }
  double output(Output output) { return module_->outputs()[output]; }

  FakeRobot robot_{2};
  std::unique_ptr<Module_Base> module_;
  std::deque<Truth> past_;
  std::vector<std::size_t> events_;
  std::minstd_rand random_{7};
  std::normal_distribution<double> noise_{0.0, 0.2};
  std::array<double, 2> rpm_{};
  bool imu_heard_ = true;  ///< Its pitch.
  int lag_ticks_ = 0;
  int imu_period_ = 1;
  int tick_ = 0;
  double yaw_sign_ = 1.0;
  double rate_sign_ = 1.0;
  double pitch_sign_ = 1.0;
  bool yaw_reversed_key_ = false;
  bool pitch_reversed_key_ = false;
  double chassis_deg_ = 0.0;
  double chassis_deg_s_ = 0.0;
  double chassis_pitch_deg_ = 0.0;
  double held_deg_ = 0.0;
  double least_deg_ = 0.0;
  double most_deg_ = 0.0;
};

class GyroLag : public LateGimbal, public ::testing::WithParamInterface<std::pair<int, int>> {};

TEST_P(GyroLag, BringsNoLimitCycleBeforeItIsKnownAndNoneAfter) {
  const auto [lag, period] = GetParam();
  build(lag, period);
  run(200);
  events_.clear();  // the sensor was heard
  aim(std::remainder(world(), 360.0), 0.0);
  run(500);
  EXPECT_TRUE(std::isnan(output(kLagMs))) << "nothing has moved yet";
  EXPECT_LT(swingOver(3000), 0.4);
  aim(40.0, 10.0);
  run(1500);
  EXPECT_NEAR(output(kLagMs), lag, 1.0);
  EXPECT_EQ(output(kAgrees), 1.0);
  EXPECT_LT(swingOver(3000), 0.4);
  EXPECT_NEAR(std::remainder(world() - 40.0, 360.0), 0.0, 0.3);
  EXPECT_TRUE(events_.empty());
}

TEST_P(GyroLag, IsTakenFromTheMotorTooWhenTheChassisTurns) {
  const auto [lag, period] = GetParam();
  build(lag, period);
  aim(40.0, 10.0);
  run(1500);
  chassis_deg_s_ = 180.0;
  // The chassis' turn before the gyro tells it, and the motor's own time.
  EXPECT_LT(swingOver(3000), 180.0 * 0.001 * (lag + period + 6));
  EXPECT_NEAR(output(kLagMs), lag, 1.0) << "the chassis teaches nothing wrong";
  EXPECT_EQ(output(kAgrees), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Lags, GyroLag,
                         ::testing::Values(std::pair{0, 1}, std::pair{3, 1}, std::pair{7, 1}, std::pair{7, 5},
                                           std::pair{8, 1}, std::pair{10, 1}, std::pair{15, 2},
                                           std::pair{20, 1}, std::pair{20, 10}));

TEST_F(LateGimbal, ALagThatChangesIsMeasuredAnew) {
  build(3);
  aim(40.0, 0.0);
  run(1500);
  ASSERT_NEAR(output(kLagMs), 3.0, 1.0);
  lag_ticks_ = 20;
  aim(-40.0, 0.0);
  run(3000);
  EXPECT_NEAR(output(kLagMs), 20.0, 1.0);
  EXPECT_LT(swingOver(2000), 0.4);
}

TEST_F(LateGimbal, AnImuPitchOfTheWrongSignIsFoundAtTheFirstDegreesAndNotFollowed) {
  for (const int lag : {0, 7, 20}) {
    pitch_sign_ = -1.0;
    robot_.motor(1).feedback.total_angle_deg = 0.0;
    robot_.motor(1).feedback.angle_deg = 0.0F;
    past_.clear();
    events_.clear();
    build(lag);
    run(300);
    aim(0.0, 5.0);
    double farthest_deg = 0.0;
    for (int i = 0; i < 2000; ++i) {
      run(1);
      farthest_deg = std::max(farthest_deg, std::fabs(pitch()));
    }
    EXPECT_THAT(events_, ElementsAre(5U)) << lag;
    EXPECT_LT(farthest_deg, 9.0) << lag;
    EXPECT_NEAR(pitch(), 5.0, 0.1) << "by the motor's angle";
    EXPECT_EQ(output(kAgrees), 0.0);
  }
}

TEST_F(LateGimbal, AHandThatTurnsADisabledGimbalShowsTheSignBeforeItIsEnabled) {
  pitch_sign_ = -1.0;
  build(7);
  robot_.motor(1).status = MotorStatus::kReady;
  run(300);
  for (int i = 0; i < 200; ++i) {
    rpm_[1] = 2.0;
    run(1);
  }
  EXPECT_THAT(events_, ElementsAre(5U));
}

TEST_F(LateGimbal, AYawOrYawRateOfTheWrongSignIsFoundToo) {
  yaw_sign_ = -1.0;
  chassis_deg_ = 100.0;
  build(7);
  run(300);
  aim(-80.0, 0.0);  // 20 deg from where it seems to look
  run(2000);
  EXPECT_THAT(events_, ElementsAre(3U));
  EXPECT_EQ(output(kStabilised), 0.0);
  EXPECT_NEAR(output(kYaw), -80.0, 0.2) << "to the chassis, from there on";
  EXPECT_NEAR(world(), 120.0, 15.0) << "twice the way until it was found";
}

TEST_F(LateGimbal, APitchThatIsAimedStaysWithoutItsSensorAndWhenThatIsBack) {
  chassis_pitch_deg_ = 10.0;
  build(7);
  run(300);
  aim(0.0, 5.0);
  run(2000);
  ASSERT_NEAR(pitch(), -5.0, 0.2);
  for (const bool heard : {false, true}) {
    imu_heard_ = heard;
    for (int i = 0; i < 500; ++i) {
      run(1);
      ASSERT_NEAR(pitch(), -5.0, 0.5) << heard;
    }
  }
  imu_heard_ = false;
  robot_.motor(1).status = MotorStatus::kReady;
  run(10);
  robot_.motor(1).status = MotorStatus::kActive;
  run(1000);
  EXPECT_NEAR(pitch(), 5.0, 0.5) << "the last word of before a stop says nothing";
}

TEST_F(LateGimbal, AYawRateOfTheWrongSignIsNotTakenOff) {
  rate_sign_ = -1.0;
  build(7);
  run(300);
  aim(20.0, 0.0);
  run(2000);
  EXPECT_THAT(events_, ElementsAre(4U));
  EXPECT_EQ(output(kStabilised), 1.0);
  EXPECT_NEAR(world(), 20.0, 0.3);
}

TEST_F(LateGimbal, TheKeysTurnTheSignsOfASensorThatIsMountedOtherwise) {
  yaw_sign_ = rate_sign_ = pitch_sign_ = -1.0;
  yaw_reversed_key_ = pitch_reversed_key_ = true;
  build(7);
  run(300);
  aim(20.0, 5.0);
  run(2000);
  EXPECT_TRUE(events_.empty());
  EXPECT_EQ(output(kAgrees), 1.0);
  EXPECT_NEAR(world(), 20.0, 0.3);
  EXPECT_NEAR(pitch(), 5.0, 0.2);
}

TEST_F(LateGimbal, ShovesAndSlopesAreNoWrongSign) {
  build(7);
  run(300);
  aim(0.0, 0.0);
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  double pitch_rate_deg_s = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    if (i % 300 == 0) {
      chassis_deg_s_ = 300.0 * any(random_);
      pitch_rate_deg_s = 60.0 * any(random_) - 3.0 * chassis_pitch_deg_;
    }
    if (i % 7'000 == 0) chassis_pitch_deg_ += 3.0 * any(random_);  // a kerb
    chassis_pitch_deg_ += pitch_rate_deg_s * 0.001;
    run(1);
  }
  EXPECT_TRUE(events_.empty());
  EXPECT_NE(output(kAgrees), 0.0);
}

TEST_F(LateGimbal, EnablingAgainComparesAgain) {
  findAnOpposedPitch();
  ASSERT_EQ(output(kAgrees), 0.0);
  robot_.motor(1).status = MotorStatus::kReady;
  run(10);
  robot_.motor(1).status = MotorStatus::kActive;
  pitch_sign_ = 1.0;  // mended meanwhile
  run(4000);
  aim(10.0, -5.0);
  run(1000);
  EXPECT_EQ(output(kAgrees), 1.0);
  EXPECT_NEAR(pitch(), -5.0, 0.2);
}

TEST_F(LateGimbal, ASensorThatWasTurnedOverWhileTheMotorsWereDisabledIsFound) {
  build(7);
  run(300);
  aim(20.0, 5.0);
  run(2000);
  ASSERT_EQ(output(kAgrees), 1.0);
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  run(10);
  yaw_sign_ = rate_sign_ = pitch_sign_ = -1.0;
  run(10);
  module_->clearInputs();
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kActive;
  run(300);
  aim(20.0, -5.0);
  double farthest_deg = 0.0;
  for (int i = 0; i < 2000; ++i) {
    run(1);
    farthest_deg = std::max(farthest_deg, std::fabs(pitch()));
  }
  EXPECT_LT(farthest_deg, 9.0);
  EXPECT_EQ(output(kAgrees), 0.0);
  EXPECT_NEAR(pitch(), -5.0, 0.5) << "by the motor";
}

TEST_F(LateGimbal, ATakeoverForgetsNoWrongSign) {
  findAnOpposedPitch();
  ASSERT_EQ(output(kAgrees), 0.0);
  robot_.motor(1).obeys = false;
  run(50);
  robot_.motor(1).obeys = true;
  run(1);
  EXPECT_EQ(output(kAgrees), 0.0);
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
