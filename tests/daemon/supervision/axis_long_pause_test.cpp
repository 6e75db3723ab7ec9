// A pause of rc10d in which a motor turns on, longer than a drive's start: where the drive counts its turns
// itself, it is told from a restart.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <tuple>

#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_long_pause_test {
namespace {

struct Counter {
  const char* name;
  const char* keys;
  double rpm;
};

void PrintTo(const Counter& subject, std::ostream* out) { *out << subject.name; }

class LongPause : public ::testing::TestWithParam<std::tuple<Counter, std::uint64_t>> {};

TEST_P(LongPause, LeavesAMotorActiveWithItsReferenceAndItsBrakeActs) {
  const auto& [subject, periods] = GetParam();
  OneMotor motor{std::string{subject.keys} + ", zero: power_on, on_timeout: brake"};
  auto& robot = motor.robot();
  const auto& shaft = robot.simBus().drive(0).physics();
  const auto apart = [&] { return motor.seen().feedback.total_angle_deg - shaft.outputAngleDeg(); };
  const double apart_deg = apart();
  motor.follow(ControlMode::kVelocity, subject.rpm, 3000);
  ASSERT_NEAR(shaft.outputRpm(), subject.rpm, 0.05 * subject.rpm);
  // A port that is stepped once makes up for a part of it alone.
  for (std::uint64_t ms = 1; ms < periods; ++ms) {
    for (const auto& port : robot.robot().simPorts())
      port->step(robot.now() + std::chrono::milliseconds{static_cast<int>(ms)});
  }
  robot.tick(periods);
  robot.run(30);
  EXPECT_EQ(motor.seen().fault, FaultCode::kNone);
  EXPECT_EQ(motor.seen().status, MotorStatus::kActive);
  EXPECT_EQ(motor.seen().acting, Acting::kBrake);
  robot.run(1500);
  EXPECT_NEAR(shaft.outputRpm(), 0.0, 1.0);
  EXPECT_TRUE(motor.seen().feedback.zeroed);
  EXPECT_NEAR(apart(), apart_deg, 0.5);
}

INSTANTIATE_TEST_SUITE_P(
    All, LongPause,
    ::testing::Combine(::testing::Values(Counter{"Lktech", "model: LK-MF9025, id: 1", 300.0},
                                         Counter{"LktechGeared", "model: LK-MG5010E-i10, id: 2", 150.0},
                                         Counter{"MyActuator", "model: RMD-X8-20, id: 3", 60.0}),
                       ::testing::Values(105U, 150U, 300U, 1000U)),
    [](const auto& each) {
      return std::string{std::get<0>(each.param).name} + std::to_string(std::get<1>(each.param));
    });

}  // namespace
}  // namespace rc10::test::axis_long_pause_test
