// The whole path: drives with physics, frames through a socket pair, fdCANbus, DJI_Motor, its loops,
// DJI_Group, and back. Virtual time.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "sim/sim_rig.hpp"

namespace rc10::test::closed_loop_test {
namespace {

using namespace std::chrono_literals;
using sim::DjiDriveConfig;
using sim::MotorLoad;

struct Case {
  std::string_view name;
  const DjiModel* model;
  DjiCommand command;
};

/// Course of a value to its target.
class Approach {
 public:
  Approach(double target, double start, double tolerance)
      : target_(target), rising_(target > start), tolerance_(tolerance) {}

  void add(double value) {
    ++ms_;
    last_ = value;
    overshoot_ = std::max(overshoot_, rising_ ? value - target_ : target_ - value);
    if (std::abs(value - target_) > tolerance_) settled_ms_ = ms_;
  }
  [[nodiscard]] double last() const { return last_; }
  [[nodiscard]] double overshoot() const { return overshoot_; }
  [[nodiscard]] int settledMs() const { return settled_ms_; }

 private:
  double target_;
  bool rising_;
  double tolerance_;
  int ms_ = 0;
  int settled_ms_ = 0;
  double last_ = 0.0;
  double overshoot_ = 0.0;
};

class ClosedLoop : public testing::TestWithParam<Case> {
 protected:
  static constexpr std::size_t kMotor = 0;

  static SimRigConfig config(const MotorLoad& load = {}) {
    SimRigConfig config;
    config.drives = {{"motor", GetParam().model, 3, GetParam().command, 0.0, load}};
    return config;
  }

  static Approach velocityTo(SimRig& rig, double rpm, Duration time) {
    Approach approach{rpm, rig.truth(kMotor).outputRpm(), 2.0};
    rig.command(kMotor, {.mode = ControlMode::kVelocity, .value = rpm});
    rig.run(time, [&] { approach.add(rig.truth(kMotor).outputRpm()); });
    return approach;
  }

  /// Moves by `deg`, in a mode of angles; the approach is of the true angle, from 0.
  static Approach angleBy(SimRig& rig, ControlMode mode, double deg, Duration time) {
    const auto& seen = rig.motor(kMotor).feedback();
    const double start_deg = rig.truth(kMotor).outputAngleDeg();
    const bool multi_turn = mode == ControlMode::kTotalAngle;
    const double wrapped = std::fmod(static_cast<double>(seen.angle_deg) + deg + 360.0, 360.0);
    Approach approach{deg, 0.0, 1.0};
    rig.command(kMotor, {.mode = mode, .value = multi_turn ? seen.total_angle_deg + deg : wrapped});
    rig.run(time, [&] { approach.add(rig.truth(kMotor).outputAngleDeg() - start_deg); });
    return approach;
  }
};

INSTANTIATE_TEST_SUITE_P(Dji, ClosedLoop,
                         testing::Values(Case{"M3508", &kM3508, DjiCommand::kCurrent},
                                         Case{"M2006", &kM2006, DjiCommand::kCurrent},
                                         Case{"GM6020Current", &kGM6020, DjiCommand::kCurrent},
                                         Case{"GM6020Voltage", &kGM6020, DjiCommand::kVoltage}),
                         [](const auto& param) { return std::string{param.param.name}; });

TEST_P(ClosedLoop, VelocityStepsSettleWithinHalfASecond) {
  SimRig rig{config()};
  rig.run(20ms);
  for (const double rpm : {100.0, -150.0, 0.0}) {
    const double step_rpm = std::abs(rpm - rig.truth(kMotor).outputRpm());
    const Approach approach = velocityTo(rig, rpm, 1500ms);
    EXPECT_LT(approach.settledMs(), 500) << "to " << rpm;
    EXPECT_LT(approach.overshoot(), 0.2 * step_rpm) << "to " << rpm;
    EXPECT_NEAR(approach.last(), rpm, 1.0);
  }
}

TEST_P(ClosedLoop, TwoTurnsSettleWithinTwoSeconds) {
  SimRig rig{config()};
  rig.run(20ms);
  for (const double deg : {720.0, -720.0}) {
    const Approach approach = angleBy(rig, ControlMode::kTotalAngle, deg, 4s);
    EXPECT_LT(approach.settledMs(), 2000) << deg;
    EXPECT_LT(approach.overshoot(), 15.0) << deg;
    EXPECT_NEAR(approach.last(), deg, 0.5);
  }
}

TEST_P(ClosedLoop, AngleGoesTheShortWayAndSettlesWithinASecond) {
  MotorLoad load;
  load.initial_angle_deg = 300.0F;
  SimRig rig{config(load)};
  rig.run(20ms);
  for (const double deg : {90.0, 90.0, -120.0}) {  // over the wrap on the way
    const Approach approach = angleBy(rig, ControlMode::kAngle, deg, 3s);
    EXPECT_LT(approach.settledMs(), 1000) << deg;
    EXPECT_LT(approach.overshoot(), 15.0) << deg;
    EXPECT_NEAR(approach.last(), deg, 0.5);
  }
}

TEST_P(ClosedLoop, AWeightIsCarriedWithoutALastingError) {
  MotorLoad load;
  load.load_torque_nm = 0.2F;
  SimRig rig{config(load)};
  rig.run(20ms);
  EXPECT_NEAR(velocityTo(rig, 60.0, 2s).last(), 60.0, 1.0);
  EXPECT_NEAR(angleBy(rig, ControlMode::kTotalAngle, 180.0, 4s).last(), 180.0, 1.5);
}

TEST_P(ClosedLoop, TenPercentOfTheFeedbackMayBeLost) {
  MotorLoad load;
  load.lost_frames = 0.1F;
  SimRig rig{config(load)};
  rig.run(20ms);
  EXPECT_LT(velocityTo(rig, 100.0, 1500ms).settledMs(), 600);
  EXPECT_NEAR(angleBy(rig, ControlMode::kTotalAngle, -720.0, 4s).last(), -720.0, 1.0);
}

TEST_P(ClosedLoop, TurnsAreCountedExactlyOverAMinuteAtFullSpeedWithLosses) {
  MotorLoad load;
  load.lost_frames = 0.2F;
  SimRig rig{config(load)};
  rig.run(20ms);
  const double offset_deg = rig.motor(kMotor).feedback().total_angle_deg - rig.truth(kMotor).outputAngleDeg();
  const double fast_rpm = 0.9 * static_cast<double>(GetParam().model->no_load_rpm);
  for (int i = 0; i < 30; ++i) {
    rig.command(kMotor, {.mode = ControlMode::kVelocity, .value = i % 3 == 2 ? -fast_rpm : fast_rpm});
    rig.run(2s);
  }
  rig.command(kMotor, {.mode = ControlMode::kVelocity, .value = 0.0});
  rig.run(2s);
  EXPECT_GT(std::abs(rig.truth(kMotor).outputAngleDeg()), 360.0 * 50);
  EXPECT_NEAR(rig.motor(kMotor).feedback().total_angle_deg - rig.truth(kMotor).outputAngleDeg(), offset_deg,
              0.1);
}

TEST_P(ClosedLoop, RestLeavesTheMotorWithoutTorque) {
  SimRig rig{config()};
  rig.run(20ms);
  (void)velocityTo(rig, 100.0, 20ms);
  ASSERT_GT(rig.truth(kMotor).currentA(), 0.1) << "it speeds up";
  (void)velocityTo(rig, 100.0, 1s);
  ASSERT_GT(rig.truth(kMotor).outputRpm(), 50.0);
  rig.motor(kMotor).order(FrameKind::kRest);
  rig.run(20ms);
  EXPECT_NEAR(rig.truth(kMotor).currentA(), 0.0,
              GetParam().command == DjiCommand::kVoltage ? 2.0 : 1e-6);  // 0 V brakes, 0 A does not
  rig.run(10s);
  EXPECT_EQ(rig.truth(kMotor).outputRpm(), 0.0);
}

TEST_P(ClosedLoop, AStallIsReleasedWithoutRunningAway) {
  SimRig rig{config()};
  rig.run(20ms);
  (void)velocityTo(rig, 60.0, 1s);
  rig.port().bus().stall(kMotor, true);
  rig.run(2s);
  rig.port().bus().stall(kMotor, false);
  const Approach approach = velocityTo(rig, 60.0, 3s);
  EXPECT_LT(approach.settledMs(), 2000);
  EXPECT_LE(std::abs(rig.truth(kMotor).outputRpm()), 62.0);
}

TEST(ClosedLoopBus, FourMotorsOfTwoFamiliesShareABus) {
  SimRigConfig config;
  config.drives = {{"left", &kM3508, 1, DjiCommand::kCurrent, 0.0, {}},
                   {"right", &kM3508, 2, DjiCommand::kCurrent, 0.0, {}},
                   {"feeder", &kM2006, 4, DjiCommand::kCurrent, 0.0, {}},
                   {"yaw", &kGM6020, 5, DjiCommand::kVoltage, 0.0, {}}};
  SimRig rig{config};
  rig.run(20ms);
  rig.command(0, {.mode = ControlMode::kVelocity, .value = 200.0});
  rig.command(1, {.mode = ControlMode::kVelocity, .value = -200.0});
  rig.command(2, {.mode = ControlMode::kVelocity, .value = 50.0});
  rig.command(3, {.mode = ControlMode::kVelocity, .value = 30.0});
  rig.run(2s);
  EXPECT_NEAR(rig.truth(0).outputRpm(), 200.0, 1.0);
  EXPECT_NEAR(rig.truth(1).outputRpm(), -200.0, 1.0);
  EXPECT_NEAR(rig.truth(2).outputRpm(), 50.0, 1.0);
  EXPECT_NEAR(rig.truth(3).outputRpm(), 30.0, 1.0);
  EXPECT_EQ(rig.bus().counters().rx_unmatched, 0U);
  EXPECT_EQ(rig.bus().counters().rx_malformed, 0U);
  EXPECT_EQ(rig.bus().counters().rx_frames, 4U * 2020U);
  EXPECT_EQ(rig.port().counters().commands, 2U * 2020U);  // 0x200 and 0x2FF
}

}  // namespace
}  // namespace rc10::test::closed_loop_test
