// Drives whose position field ends, and says no more than that beyond: a shaft that a hand or a load takes
// there and back is braked and held again.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>

#include "daemon/one_motor_robot.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::scale_end_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMotor = 0;

struct Subject {
  const char* name;
  const char* motor;
  double end_deg;
  bool resists_there;  ///< Its brake needs no place.
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

constexpr Subject kSubjects[] = {
    {"CyberGearByPlace", "model: CyberGear, id: 4, control: position", 716.2, false},
    {"RobStrideByPlace", "model: RS00, id: 3, control: position, position_range_rad: 12.5", 716.2, false},
    {"CyberGear", "model: CyberGear, id: 4", 716.2, true},
    {"RobStride", "model: RS00, id: 3, position_range_rad: 12.5", 716.2, true},
    {"CubeMarsServo", "model: AK80-9, id: 6, position_basis: rotor, brake_current_a: 5", 3200.0 / 9.0, true},
};

enum class Begins { kTimeout, kEstop };

class EndOfTheScale : public ::testing::TestWithParam<std::tuple<Subject, const char*, Begins>> {
 protected:
  /// A fallback acts on the shaft at 0 deg.
  void start() {
    const std::string action = std::get<1>(GetParam());
    robot_ = std::make_unique<VirtualRobot>(oneMotorRobot(
        std::string{subject().motor} + ", zero: power_on, on_timeout: " + action + ", on_estop: " + action +
        ", brake_max_s: 600, hold_max_s: 600, simulated: {inertia_kg_m2: 0.05}"));
    for (int i = 0; i < 4000 && seen().status != MotorStatus::kReady; ++i) robot_->run(1);
    for (int i = 0; i < 4 && seen().status != MotorStatus::kActive; ++i) {
      robot_->order(Operation::kEnable);
      robot_->run(1000);
    }
    ASSERT_EQ(seen().status, MotorStatus::kActive);
    robot_->hold(kMotor, {.mode = ControlMode::kTotalAngle}, 500);
    if (std::get<2>(GetParam()) == Begins::kEstop) robot_->order(Operation::kEstop);
    robot_->run(200);
    ASSERT_EQ(seen().acting, wanted());
  }
  /// By a hand that nothing resists, to this angle of the drive.
  void take(double to_deg) {
    auto& shaft = physics();
    shaft.take({.by_deg = to_deg - shaftDeg(), .speed_rpm = 20.0, .torque_nm = 500.0, .hold = 300ms});
    robot_->run(5);
    while (shaft.held()) robot_->run(1);
  }
  [[nodiscard]] static Acting wanted() {
    return std::string{std::get<1>(GetParam())} == "hold" ? Acting::kHold : Acting::kBrake;
  }
  static const Subject& subject() { return std::get<Subject>(GetParam()); }
  const MotorSnapshot& seen() { return robot_->motor(kMotor); }
  sim::MotorPhysics& physics() { return robot_->simBus().drive(kMotor).physics(); }
  double shaftDeg() { return physics().outputAngleDeg(); }

  std::unique_ptr<VirtualRobot> robot_;
};

TEST_P(EndOfTheScale, TakesNeitherBrakeNorHoldFromAShaftThatIsBackWithinIt) {
  start();
  take(subject().end_deg + 60.0);
  ASSERT_TRUE(seen().feedback.angle_at_end);
  EXPECT_FALSE(seen().feedback.zeroed);
  ASSERT_EQ(seen().acting, wanted());
  const double beyond_deg = shaftDeg();
  robot_->run(1000);
  EXPECT_GT(shaftDeg(), beyond_deg - 5.0) << "nothing pulls it back from there";
  robot_->simBus().setLoad(kMotor, {.inertia_kg_m2 = 0.05F, .load_torque_nm = 0.3F});
  robot_->run(500);
  if (subject().resists_there) {
    EXPECT_LT(std::fabs(physics().outputRpm()), 5.0);
  } else {
    EXPECT_GT(std::fabs(physics().outputRpm()), 5.0) << "it has no place to brake at";
    EXPECT_NE(seen().limits & kLimitAngle, 0U);
  }
  robot_->simBus().setLoad(kMotor, {.inertia_kg_m2 = 0.05F});
  take(subject().end_deg - 100.0);
  ASSERT_FALSE(seen().feedback.angle_at_end);
  ASSERT_EQ(seen().acting, wanted()) << static_cast<int>(seen().fault);
  robot_->simBus().setLoad(kMotor, {.inertia_kg_m2 = 0.05F, .load_torque_nm = 0.3F});
  robot_->run(2000);
  EXPECT_LT(std::fabs(physics().outputRpm()), 5.0);
  EXPECT_GT(shaftDeg(), subject().end_deg - 120.0);
  EXPECT_LT(shaftDeg(), subject().end_deg + 20.0);
  if (wanted() == Acting::kHold) {
    EXPECT_NEAR(shaftDeg(), robot_->robot().motors()[kMotor].motor->heldAngleDeg(), 35.0)
        << "and the sag of a spring";
  }
}

std::string nameOf(const ::testing::TestParamInfo<EndOfTheScale::ParamType>& made) {
  const bool estop = std::get<Begins>(made.param) == Begins::kEstop;
  return std::string{std::get<Subject>(made.param).name} + "_" + std::get<1>(made.param) +
         (estop ? "_estop" : "_timeout");
}

INSTANTIATE_TEST_SUITE_P(Drives, EndOfTheScale,
                         ::testing::Combine(::testing::ValuesIn(kSubjects),
                                            ::testing::Values("brake", "hold"),
                                            ::testing::Values(Begins::kTimeout, Begins::kEstop)),
                         nameOf);

}  // namespace
}  // namespace rc10::test::scale_end_test
