// Soft limits of drives that speak, or are told, some times a second.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::seldom_heard_limit_test {
namespace {

struct Seldom {
  const char* name;
  const char* keys;
  double gap_periods = 1.0;  ///< Feedback lost, less than looks like a restart.
};

void PrintTo(const Seldom& seldom, std::ostream* out) { *out << seldom.name; }

constexpr Seldom kSeldom[] = {
    {"OdriveAtTenHertz",
     "model: ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 40, "
     "velocity_limit_rpm: 600, feedback_hz: 10, zero: power_on",
     2.0},
    {"OdriveAtFiveHertz",
     "model: ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 40, "
     "velocity_limit_rpm: 600, feedback_hz: 5, zero: power_on",
     2.0},
    {"OdriveToldSeldom",
     "model: ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 40, "
     "velocity_limit_rpm: 600, feedback_hz: 100, command_divider: 100, zero: power_on",
     2.0},
    {"CubeMarsAtTenHertz", "model: AK80-9, id: 5, feedback_hz: 10, zero: power_on"},
    {"CubeMarsAtFiveHertz", "model: AK80-9, id: 5, feedback_hz: 5, zero: power_on"},
    {"RobStrideToldSeldom", "model: RS00, id: 3, control: velocity, command_divider: 99, watchdog_ms: 400"},
    {"RmdToldSeldom", "model: RMD-X8-20, id: 11, command_divider: 49, zero: power_on"},
    {"LkTechToldSeldom", "model: LK-MG5010E-i10, id: 12, command_divider: 49, zero: power_on"},
    {"RmdAtOneKilohertz", "model: RMD-X8-20, id: 11, zero: power_on", 5.0},
};

class SeldomHeardLimit : public ::testing::TestWithParam<std::tuple<Seldom, int>> {
 protected:
  static std::string keys() {
    return std::string{std::get<0>(GetParam()).keys} +
           ", angle_min_deg: -90, angle_max_deg: 90, direction: " + std::to_string(std::get<1>(GetParam()));
  }
  /// Farthest place of the shaft itself, in the sense of `rpm`, while it is sent there for 5 s. `gap`: frames
  /// are lost on the way.
  double farthestDeg(double rpm, bool gap) {
    OneMotor motor{keys()};
    auto& bus = motor.robot().simBus();
    const double sense = (rpm < 0.0 ? -1.0 : 1.0) * std::get<1>(GetParam());
    const double start_deg = bus.drive(0).physics().outputAngleDeg();
    const auto wayDeg = [&] { return sense * (bus.drive(0).physics().outputAngleDeg() - start_deg); };
    double farthest_deg = 0.0;
    const double gap_ms = std::get<0>(GetParam()).gap_periods * 1000 / motor.config().settings.feedback_hz;
    int left = gap ? static_cast<int>(gap_ms) : -1;
    for (int i = 0; i < 5000; ++i) {
      motor.follow(ControlMode::kVelocity, rpm, 1);
      farthest_deg = std::max(farthest_deg, wayDeg());
      if (left >= 0 && wayDeg() > 20.0) bus.silence(0, left-- > 0);
    }
    EXPECT_EQ(motor.seen().status, MotorStatus::kActive);
    return farthest_deg;
  }
};

TEST_P(SeldomHeardLimit, StopsAVelocity) {
  for (const double rpm : {200.0, -200.0}) {
    const double farthest_deg = farthestDeg(rpm, false);
    EXPECT_LT(farthest_deg, 93.0);
    EXPECT_GT(farthest_deg, 85.0);
  }
}

TEST_P(SeldomHeardLimit, StopsAVelocityWhileFramesAreLost) {
  EXPECT_LT(farthestDeg(200.0, true), 93.0);
  EXPECT_LT(farthestDeg(-200.0, true), 93.0);
}

INSTANTIATE_TEST_SUITE_P(Drives, SeldomHeardLimit,
                         ::testing::Combine(::testing::ValuesIn(kSeldom), ::testing::Values(1, -1)),
                         [](const auto& made) {
                           return std::string{std::get<0>(made.param).name} +
                                  (std::get<1>(made.param) < 0 ? "Reversed" : "");
                         });

}  // namespace
}  // namespace rc10::test::seldom_heard_limit_test
