// Stalls and runaways of every family in each of its controls: its current must be seen at the limit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/motor_families.hpp"
#include "daemon/supervision/family_variants.hpp"
#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_stall_test {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Row = FamilyRow;

const Row kRows[] = {
    {"model: M3508, id: 1, current_limit_a: 5, zero: power_on", ""},
    {"model: GM6020, id: 5", "command"},
    {"model: VESC, id: 10, pole_pairs: 7, motor_current_max_a: 40, velocity_limit_rpm: 3000, "
     "kv_rpm_per_v: 190, feedback_hz: 200, zero: power_on",
     "angle", 1000.0},
    {"model: DM4310, id: 1, master_id: 17, velocity_damping_nms_per_rad: 5", "control"},
    // Its largest current is beyond the scale of the torque, and so is that of the RS03.
    {"model: DM4340, id: 2, master_id: 18, velocity_limit_rpm: 50, control: force_position", "", 40.0},
    {"model: RS00, id: 3, current_limit_a: 4", "control"},
    {"model: RS03, id: 4", "control"},
    {"model: CyberGear, id: 5, current_limit_a: 4, zero: power_on", "control"},
    {"model: AK80-9, id: 6, current_limit_a: 4, zero: power_on", "protocol"},
    {"model: AK80-9-V3, id: 7, current_limit_a: 4, zero: power_on", "protocol"},
    {"model: moteus, id: 8, motor_kv_rpm_per_v: 100, current_limit_a: 5, zero: power_on", "", 600.0,
     "data_bitrate: 5000000\n    "},
    {"model: ODrive_S1, id: 9, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
     "telemetry_hz: 100, zero: power_on",
     "", 300.0},
    {"model: ODrive_v3, id: 11, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: "
     "600, "
     "telemetry_hz: 10, zero: power_on",
     "", 300.0},
    {"model: RMD-X8-20, id: 22, current_limit_a: 6, zero: power_on", ""},
    {"model: RMD-X8-20, id: 23, current_limit_a: 10.399, zero: power_on", ""},
    {"model: LK-MG5010E-i10, id: 12, current_limit_a: 5, velocity_limit_rpm: 300, zero: power_on", ""},
};

struct Subject {
  std::string keys;
  double rpm;
  const char* bus;
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.keys; }

const std::string kWatched = ", stall_ms: 300";

/// Those whose configuration takes the keys.
std::vector<Subject> subjects(const std::string& more) {
  std::vector<Subject> found;
  for (const Row& row : kRows) {
    for (const auto& keys : variantsOf(row)) {
      if (OneMotor::parse(keys + more, row.bus).config) found.push_back({keys, row.rpm, row.bus});
    }
  }
  return found;
}

TEST(StallOfAFamily, IsPromisedByEachButWhereTheDriveAloneKnowsItsLimit) {
  std::set<std::string_view> tried;
  std::vector<std::string> refused;
  for (const Row& row : kRows) {
    tried.insert(familyOfKeys(row.keys).name());
    for (const auto& keys : variantsOf(row)) {
      const auto outcome = OneMotor::parse(keys + kWatched, row.bus);
      if (outcome.config || !OneMotor::parse(keys, row.bus).config) continue;  // a protocol of other models
      EXPECT_THAT(outcome.errorText(), HasSubstr("needs to see when the current is at its limit")) << keys;
      const auto name = keys.find(' ') + 1;
      refused.push_back(keys.substr(name, keys.find(',') - name) + keys.substr(keys.rfind(' ')));
    }
  }
  EXPECT_THAT(refused,
              ElementsAre("DM4310 position_velocity", "DM4310 velocity", "AK80-9 servo", "AK80-9-V3 servo"));
  for (const auto& entry : motorFamilies())
    EXPECT_TRUE(tried.contains(entry.family->name())) << entry.family->name();
}

MotorTraits traitsOf(const OneMotor& motor) {
  const auto& config = motor.config();
  return config.family->traits(config.settings.model, config.settings.own);
}

/// Torque at the limit of its current, at the output shaft.
double fullNm(OneMotor& motor) {
  const auto& parameters = motor.robot().simBus().motor(0).parameters();
  double limit_a = parameters.current_limit_a;
  const auto traits = traitsOf(motor);
  if (traits.effort == CommandUnit::kAmpere) {
    const float own_a = effortLimitOf(motor.config().settings, traits.effort_full_scale);
    limit_a = std::min(limit_a, static_cast<double>(own_a));
  }
  return limit_a * parameters.torque_nm_per_a * parameters.gear_ratio;
}

void load(OneMotor& motor, float sim::MotorLoad::*figure, double value) {
  auto& bus = motor.robot().simBus();
  auto hung = bus.drive(0).load();
  hung.*figure = static_cast<float>(value);
  bus.setLoad(0, hung);
}

/// A target that takes all its torque against a heavy load; what it has first of velocity, angle, current.
std::pair<ControlMode, double> taskOf(const OneMotor& motor, double rpm) {
  const auto modes = traitsOf(motor).modes;
  if (modes.contains(ControlMode::kVelocity)) return {ControlMode::kVelocity, rpm};
  if (modes.contains(ControlMode::kTotalAngle)) return {ControlMode::kTotalAngle, 300.0};
  return {ControlMode::kCurrent, 1e3};
}

/// Its fault while a load grows until it is more than the drive has, and turns it the other way.
FaultCode faultOfOverload(OneMotor& motor, double rpm) {
  const auto [mode, value] = taskOf(motor, rpm);
  motor.follow(mode, value, 500);
  EXPECT_EQ(motor.seen().fault, FaultCode::kNone);
  for (int i = 0; i < 4000 && motor.seen().fault == FaultCode::kNone; ++i) {
    load(motor, &sim::MotorLoad::load_torque_nm, fullNm(motor) * (1.0 + i / 500.0));
    motor.follow(mode, value, 1);
  }
  return motor.seen().fault;
}

TEST(StallOfAFamily, AShaftThatALoadTurnsTooFastIsOverspeedWhereItsLimitIsNotSeen) {
  for (const std::string keys :
       {"model: DM4310, id: 1, master_id: 17, control: velocity",
        "model: DM4310, id: 1, master_id: 17, control: position_velocity", "model: AK80-9, id: 6",
        "model: ODrive_v3, id: 11, torque_constant_nm_per_a: 0.05, current_limit_a: 20, "
        "velocity_limit_rpm: 600"}) {
    SCOPED_TRACE(keys);
    OneMotor motor{keys};
    const auto fault = faultOfOverload(motor, 60.0);
    if (familyOfKeys(keys).name() == "Damiao") {  // whose position cannot be followed so fast
      EXPECT_THAT(fault, AnyOf(FaultCode::kOverspeed, FaultCode::kEncoderJump));
    } else {
      EXPECT_EQ(fault, FaultCode::kOverspeed);
    }
  }
}

class StallTest : public ::testing::TestWithParam<Subject> {
 protected:
  static OneMotor motorWith(const std::string& more) {
    return OneMotor{GetParam().keys + more, GetParam().bus};
  }
};

// The limit of a loop of the drive acts in each turn of the motor, and between them.
TEST_P(StallTest, IsSeenInEachModeWhateverTheRhythmOfItsCommands) {
  const auto& family = familyOfKeys(GetParam().keys);
  for (const int divider : {1, 2, 5}) {
    if (family.name() == "DJI" && divider > 1) break;  // shares its frames
    for (const auto& [mode, value] :
         {std::pair{ControlMode::kVelocity, GetParam().rpm}, std::pair{ControlMode::kTotalAngle, 300.0},
          std::pair{ControlMode::kCurrent, 1e3}, std::pair{ControlMode::kVoltage, 1e3},
          std::pair{ControlMode::kDuty, 1.0}}) {
      const std::string rhythm = divider > 1 ? ", command_divider: " + std::to_string(divider) : "";
      SCOPED_TRACE(std::string{toString(mode)} + rhythm);
      OneMotor motor = motorWith(kWatched + rhythm + ", simulated: {stalled: true}");
      if (!traitsOf(motor).modes.contains(mode)) continue;
      motor.follow(mode, value, 2000);
      EXPECT_EQ(motor.seen().fault, FaultCode::kStalled);
    }
  }
}

TEST_P(StallTest, IsNoneWhileAHeavyLoadGainsSpeedAtFullCurrentAndWhereItStopsAgain) {
  OneMotor motor = motorWith(kWatched);
  const auto [mode, value] = taskOf(motor, GetParam().rpm);
  // An angle that it overshoots, over and over.
  const double gains_for_s = mode == ControlMode::kVelocity ? 1.5 : 0.5;
  const double rad_s = GetParam().rpm * 2.0 * std::numbers::pi / 60.0;
  load(motor, &sim::MotorLoad::inertia_kg_m2, fullNm(motor) * gains_for_s / rad_s);
  int limited = 0;
  for (const double target : {value, 0.0}) {
    for (int i = 0; i < 4000; ++i) {
      motor.follow(mode, target, 1);
      if ((motor.seen().limits & kLimitCurrent) != 0) ++limited;
      ASSERT_EQ(motor.seen().fault, FaultCode::kNone) << target << ", tick " << i;
    }
  }
  EXPECT_GT(limited, 300) << "ms, as long as a stall";
}

TEST_P(StallTest, ARunawayIsSeenTooButWhereTheLoopYields) {
  OneMotor motor = motorWith("");
  const auto traits = traitsOf(motor);
  const FaultCode fault = faultOfOverload(motor, GetParam().rpm);
  if (traits.yields) {
    EXPECT_NE(fault, FaultCode::kRunaway);
  } else if (traits.signed_current_hz == 10) {
    EXPECT_THAT(fault, AnyOf(FaultCode::kRunaway, FaultCode::kOverspeed)) << "before two reports";
  } else {
    EXPECT_EQ(fault, FaultCode::kRunaway);
  }
}

// A bare shaft is soon so fast that back-EMF takes its current from the limit.
TEST_P(StallTest, AReversedEncoderIsARunawayInEachLoop) {
  for (const auto& [mode, value] :
       {std::pair{ControlMode::kVelocity, GetParam().rpm}, std::pair{ControlMode::kAngle, 90.0},
        std::pair{ControlMode::kTotalAngle, 300.0}}) {
    SCOPED_TRACE(std::string{toString(mode)});
    OneMotor motor = motorWith("");
    const auto traits = traitsOf(motor);
    if (traits.yields || !traits.modes.contains(mode)) continue;
    motor.robot().simBus().setEncoderFault(0, {.reversed = true});
    float fastest_rpm = 0.0F;
    for (int i = 0; i < 3000; ++i) {
      motor.follow(mode, value, 1);
      fastest_rpm = std::max(fastest_rpm, std::fabs(motor.seen().feedback.velocity_rpm));
    }
    // The other way to an angle is the shorter beyond half a turn: there it may settle.
    const bool settles = mode == ControlMode::kAngle && motor.seen().fault == FaultCode::kNone;
    if (settles) {
      EXPECT_LT(fastest_rpm, 2.0F * motor.config().guard.runaway_rpm);
      continue;
    }
    // Where the no-load speed is not known, one and a half times the user's limit may come first.
    const auto also = traits.no_load_rpm > 0.0F ? FaultCode::kRunaway : FaultCode::kOverspeed;
    EXPECT_THAT(motor.seen().fault, AnyOf(FaultCode::kRunaway, also));
  }
}

TEST(RunawayOfMyActuator, IsSeenAtThePeakOfItsModelWhereNoLimitIsWritten) {
  OneMotor motor{"model: RMD-X8-20, id: 24, zero: power_on", ""};
  motor.robot().simBus().setEncoderFault(0, {.reversed = true});
  motor.follow(ControlMode::kVelocity, 60.0, 3000);
  EXPECT_EQ(motor.seen().fault, FaultCode::kRunaway);
}

// A shove during the loop is over when the next order comes.
TEST_P(StallTest, AShoveBeforeItIsLetGoIsNoRunaway) {
  const auto [mode, value] = taskOf(OneMotor{GetParam().keys, GetParam().bus}, GetParam().rpm);
  if (mode == ControlMode::kCurrent || traitsOf(OneMotor{GetParam().keys, GetParam().bus}).yields) return;
  for (const int shove_ms : {20, 60, 90}) {
    SCOPED_TRACE(shove_ms);
    OneMotor motor = motorWith("");
    motor.follow(mode, 0.0, 100);
    for (int i = 0; i < shove_ms && motor.seen().fault == FaultCode::kNone; ++i) {
      load(motor, &sim::MotorLoad::load_torque_nm, 3.0 * fullNm(motor));
      motor.follow(mode, 0.0, 1);
    }
    if (motor.seen().fault != FaultCode::kNone) break;  // a tick after the limit where rc10d computes it
    load(motor, &sim::MotorLoad::load_torque_nm, 0.0);
    motor.follow(ControlMode::kCoast, 0.0, 200);
    EXPECT_EQ(motor.seen().fault, FaultCode::kNone);
    EXPECT_EQ(motor.seen().status, MotorStatus::kActive);
  }
}

TEST_P(StallTest, LettingAHeavyLoadDownAsAskedIsNoRunaway) {
  OneMotor motor = motorWith("");
  if (!traitsOf(motor).limit_by_report || !traitsOf(motor).modes.contains(ControlMode::kVelocity)) return;
  load(motor, &sim::MotorLoad::inertia_kg_m2, 0.05);
  load(motor, &sim::MotorLoad::load_torque_nm, -0.97 * fullNm(motor));
  int braked = 0;
  for (int i = 0; i < 3000; ++i) {
    motor.follow(ControlMode::kVelocity, GetParam().rpm * std::min(i / 2000.0, 1.0), 1);
    ASSERT_EQ(motor.seen().fault, FaultCode::kNone) << "tick " << i;
    if ((motor.seen().limits & kLimitCurrent) != 0) ++braked;
  }
  EXPECT_GT(braked, 0);
}

INSTANTIATE_TEST_SUITE_P(All, StallTest, ::testing::ValuesIn(subjects(kWatched)));

}  // namespace
}  // namespace rc10::test::axis_stall_test
