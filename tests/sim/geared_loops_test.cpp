// Default gains behind a gear of the user's own, on the simulated motor behind that gear.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "sim/sim_rig.hpp"

namespace rc10::test::geared_loops_test {
namespace {

using namespace std::chrono_literals;

/// `turns`: of the model's own output in one of the shaft.
struct Case {
  std::string_view name;
  const DjiModel* model;
  DjiCommand command;
  double turns;
};

/// Course of a step: relative to its height.
struct Course {
  double overshoot = 0.0;
  double ripple = 0.0;  ///< Largest less smallest value of the last half second.
  double error = 0.0;   ///< At the end.
};

class GearedLoops : public testing::TestWithParam<Case> {
 protected:
  GearedLoops() : rig_(config()) { rig_.run(20ms); }

  /// `now`: the value that goes from 0 to `height`.
  template <typename Value>
  Course step(const Target& target, double height, const Value& now) {
    constexpr int kTicks = 2000;
    constexpr int kSettled = 1500;
    Course course;
    double least = height;
    double most = height;
    double last = 0.0;
    int ticks = 0;
    rig_.command(0, target);
    rig_.run(std::chrono::milliseconds{kTicks}, [&] {
      last = now();
      course.overshoot = std::max(course.overshoot, last / height - 1.0);
      if (++ticks < kSettled) return;
      least = std::min(least, last);
      most = std::max(most, last);
    });
    course.ripple = (most - least) / height;
    course.error = std::abs(last / height - 1.0);
    return course;
  }

  [[nodiscard]] const sim::MotorPhysics& shaft() const { return rig_.truth(0); }

  SimRig rig_;

 private:
  static SimRigConfig config() {
    SimRigConfig config;
    const Case& test = GetParam();
    config.drives = {{"motor", test.model, 3, test.command, test.turns * test.model->gear_ratio, {}}};
    return config;
  }
};

INSTANTIATE_TEST_SUITE_P(Dji, GearedLoops,
                         testing::Values(Case{"BareM3508", &kM3508, DjiCommand::kCurrent, 187.0 / 3591.0},
                                         Case{"BareM2006", &kM2006, DjiCommand::kCurrent, 1.0 / 36.0},
                                         Case{"HalvedM3508", &kM3508, DjiCommand::kCurrent, 2.0},
                                         Case{"HalvedM2006", &kM2006, DjiCommand::kCurrent, 2.0},
                                         Case{"HalvedGM6020Current", &kGM6020, DjiCommand::kCurrent, 2.0},
                                         Case{"DoubledGM6020Current", &kGM6020, DjiCommand::kCurrent, 0.5},
                                         Case{"HalvedGM6020Voltage", &kGM6020, DjiCommand::kVoltage, 2.0},
                                         Case{"DoubledGM6020Voltage", &kGM6020, DjiCommand::kVoltage, 0.5}),
                         [](const auto& param) { return std::string{param.param.name}; });

TEST_P(GearedLoops, AVelocityStepSettlesWithoutALimitCycle) {
  const double rpm = 100.0 / GetParam().turns;
  const Course course =
      step({.mode = ControlMode::kVelocity, .value = rpm}, rpm, [&] { return shaft().outputRpm(); });
  EXPECT_LT(course.overshoot, 0.2);
  EXPECT_LT(course.ripple, 0.02);
  EXPECT_LT(course.error, 0.01);
}

TEST_P(GearedLoops, AnAngleStepSettlesWithoutALimitCycle) {
  const double deg = 720.0 / GetParam().turns;
  const double start_deg = shaft().outputAngleDeg();
  const Target target{.mode = ControlMode::kTotalAngle,
                      .value = rig_.motor(0).feedback().total_angle_deg + deg};
  const Course moved = step(target, deg, [&] { return shaft().outputAngleDeg() - start_deg; });
  const Course course = step(target, deg, [&] { return shaft().outputAngleDeg() - start_deg; });
  EXPECT_LT(moved.overshoot, 0.02);
  EXPECT_LT(course.ripple, 0.002);
  EXPECT_LT(course.error, 0.002);
}

// Behind no gear that is more than the limit of the model's own output.
TEST_P(GearedLoops, ReachesNineTenthsOfTheNoLoadSpeedOfItsRotor) {
  const double rpm = 0.9 * static_cast<double>(GetParam().model->no_load_rpm) / GetParam().turns;
  const Course course =
      step({.mode = ControlMode::kVelocity, .value = rpm}, rpm, [&] { return shaft().outputRpm(); });
  EXPECT_LT(course.error, 0.01);
}

}  // namespace
}  // namespace rc10::test::geared_loops_test
