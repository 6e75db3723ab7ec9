// Soft limits, in every mode of every family.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/supervision/family_variants.hpp"
#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_soft_limit_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kEndDeg = 90.0;
// A step of the target would show what a loop overshoots by.
const std::string kLimits = ", angle_min_deg: -90, angle_max_deg: 90, angle_slew_deg_per_s: 180";
const std::string kZeroed = ", zero: power_on";

struct Subject {
  std::string keys;
  const char* bus;
  double rpm;
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.keys; }

/// The keys with soft limits and an angle from the start; empty: they are refused.
std::string bounded(const std::string& keys, const char* bus) {
  for (const auto& zero : {kZeroed, std::string{}}) {
    if (OneMotor::parse(keys + kLimits + zero, bus).config) return keys + kLimits + zero;
  }
  return {};
}

std::vector<Subject> subjects() {
  std::vector<Subject> found;
  for (const FamilyRow& row : kEveryControl) {
    for (const auto& keys : variantsOf(row)) {
      const auto with_limits = bounded(keys, row.bus);
      if (!with_limits.empty()) found.push_back({with_limits, row.bus, row.rpm});
    }
  }
  return found;
}

/// Targets of this mode that lead outwards by each of the fields that it uses.
std::vector<Target> outwards(ControlMode mode, double rpm) {
  constexpr double kFarDeg = 3600.0;
  switch (mode) {
    case ControlMode::kCurrent: return {{.mode = mode, .value = 3.0}, {.mode = mode, .torque_ff_nm = 0.3F}};
    case ControlMode::kVoltage: return {{.mode = mode, .value = 12.0}};
    case ControlMode::kDuty: return {{.mode = mode, .value = 0.1}};
    case ControlMode::kVelocity:
      return {{.mode = mode, .value = rpm}, {.mode = mode, .value = rpm, .torque_ff_nm = 0.3F}};
    case ControlMode::kAngle: return {{.mode = mode, .value = 170.0}};
    case ControlMode::kTotalAngle:
      return {{.mode = mode, .value = kFarDeg},
              {.mode = mode, .value = kEndDeg + 1.0, .velocity_ff_rpm = 60.0F},
              {.mode = mode, .value = kEndDeg + 1.0, .torque_ff_nm = 0.3F}};
    case ControlMode::kImpedance:
      return {{.mode = mode, .value = kFarDeg, .stiffness_nm_per_rad = 10.0F, .damping_nms_per_rad = 0.5F},
              {.mode = mode, .value = kEndDeg, .stiffness_nm_per_rad = 10.0F},
              {.mode = mode, .torque_ff_nm = 0.3F, .damping_nms_per_rad = 0.1F},
              {.mode = mode, .velocity_ff_rpm = 60.0F, .damping_nms_per_rad = 0.5F}};
    case ControlMode::kCoast:
    case ControlMode::kBrake: break;
  }
  return {};
}

Target mirrored(Target target) {
  target.value = -target.value;
  target.velocity_ff_rpm = -target.velocity_ff_rpm;
  target.torque_ff_nm = -target.torque_ff_nm;
  return target;
}

constexpr ControlMode kModes[] = {ControlMode::kCurrent,  ControlMode::kVoltage, ControlMode::kDuty,
                                  ControlMode::kVelocity, ControlMode::kAngle,   ControlMode::kTotalAngle,
                                  ControlMode::kImpedance};

class SoftLimitTest : public ::testing::TestWithParam<Subject> {};

TEST_P(SoftLimitTest, HoldsAgainstEachFieldOfATargetInEveryMode) {
  for (const auto mode : kModes) {
    for (const auto& target : outwards(mode, GetParam().rpm)) {
      OneMotor motor{GetParam().keys, GetParam().bus};
      if (!motor.config().traits().modes.contains(mode)) break;
      SCOPED_TRACE(::testing::Message() << toString(mode) << " " << target.value << ", ff "
                                        << target.velocity_ff_rpm << " rpm " << target.torque_ff_nm << " Nm");
      for (const double sign : {1.0, -1.0}) {  // the second is back, and to the other end
        const Target one_way = sign > 0.0 ? target : mirrored(target);
        double farthest_deg = -kEndDeg;
        bool limited = false;
        for (int i = 0; i < 2000; ++i) {
          motor.robot().hold(0, one_way, 1);
          farthest_deg = std::max(farthest_deg, sign * motor.seen().feedback.total_angle_deg);
          limited = limited || (motor.seen().limits & kLimitAngle) != 0;
        }
        EXPECT_EQ(motor.seen().status, MotorStatus::kActive) << static_cast<int>(motor.seen().fault);
        EXPECT_LT(farthest_deg, kEndDeg + 6.0);
        EXPECT_TRUE(limited || farthest_deg < 0.9 * kEndDeg) << "friction holds it, or the limit";
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SoftLimitTest, ::testing::ValuesIn(subjects()));

TEST(SoftLimitsOfAFamily, AreRefusedWhereThereIsNoAngleAlone) {
  std::set<std::string_view> tried;
  std::vector<std::string> refused;
  for (const FamilyRow& row : kEveryControl) {
    for (const auto& keys : variantsOf(row)) {
      const auto outcome = OneMotor::parse(keys, row.bus);
      if (!outcome.config) continue;  // a protocol of other models
      const auto& motor = outcome.config->buses[0].motors[0];
      if (bounded(keys, row.bus).empty()) {
        refused.push_back(keys);
      } else {
        tried.insert(motor.family->name());
      }
    }
  }
  EXPECT_THAT(refused, ElementsAre(AllOf(HasSubstr("VESC"), HasSubstr("angle: none"))));
  for (const auto& entry : builtInFamilies())
    EXPECT_TRUE(tried.contains(entry.family->name())) << entry.family->name();
}

}  // namespace
}  // namespace rc10::test::axis_soft_limit_test
