#include "faults/oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "faults/chaos.hpp"
#include "faults/robots.hpp"

namespace rc10::test {
namespace oracle_test {

using Kind = Chaos::Lie::Kind;

constexpr std::uint64_t kMostTicks = 1'200'000;

struct Case {
  std::size_t robot = 0;
  std::size_t motor = 0;
  std::string name;  ///< Robot and motor.
  std::string motor_name;
  friend void PrintTo(const Case& which, std::ostream* out) { *out << which.name; }
};

template <typename Wanted>
std::vector<Case> motorsWith(const Wanted& wanted) {
  std::vector<Case> cases;
  for (std::size_t robot = 0; robot < kRobotCount; ++robot) {
    const RobotConfig config = robotOf(robot);
    std::size_t motor = 0;
    for (const auto& bus : config.buses) {
      for (const auto& entry : bus.motors) {
        if (wanted(entry)) cases.push_back({robot, motor, config.robot + "_" + entry.name(), entry.name()});
        ++motor;
      }
    }
  }
  return cases;
}

std::vector<Case> everyMotor() {
  return motorsWith([](const MotorConfig&) { return true; });
}

std::string findingOf(Chaos::Lie lie) {
  SeededChoices choices{7};
  Chaos chaos{choices, lie};
  try {
    while (chaos.ticks() < kMostTicks) chaos.step();
  } catch (const Violation& finding) {
    return finding.what();
  }
  return "nothing";
}

/// The oracle's own proof: of each motor of the soak, in each family, it sees what is wrong.
class OracleSees : public ::testing::TestWithParam<Case> {
 protected:
  static std::string findingOf(Kind kind) {
    return oracle_test::findingOf({GetParam().robot, GetParam().motor, kind});
  }
};

TEST_P(OracleSees, AMotorThatGoesOnThoughNobodyCommandsIt) {
  // It may see that by the rule of rest, of slew limits, or by what the robot says of its own frames.
  EXPECT_THAT(findingOf(Kind::kStuck), ::testing::HasSubstr(", motor " + GetParam().motor_name + " ("));
}

constexpr std::size_t kRobotWithAJoint = 4;

TEST(OracleSeesOfAScan, ThatItAsksBeforeItHasListened) {
  EXPECT_THAT(findingOf({.robot = 0, .kind = Kind::kPace}), ::testing::HasSubstr("before it has listened"));
}

TEST(OracleSeesOfAJoint, ThatItIsPushedOnBeyondItsHomingVelocity) {
  EXPECT_THAT(findingOf({.robot = kRobotWithAJoint, .kind = Kind::kHoming}),
              ::testing::HasSubstr("beyond its homing velocity"));
}

TEST(OracleSeesOfAJoint, ThatItHomesFartherThanItsTravel) {
  EXPECT_THAT(findingOf({.robot = kRobotWithAJoint, .kind = Kind::kTravel}),
              ::testing::HasSubstr("farther than its travel"));
}

constexpr std::size_t kRobotWithAGimbal = 7;

TEST(OracleSeesOfAGimbal, ThatItHoldsForNobody) {
  ASSERT_EQ(robotOf(kRobotWithAGimbal).modules.at(1).type->name(), "gimbal");
  EXPECT_THAT(findingOf({.robot = kRobotWithAGimbal, .kind = Kind::kSilence}),
              ::testing::HasSubstr("holds for nobody"));
}

constexpr std::size_t kRobotWithSlewLimits = 5;

/// The motors of the soak that have such a limit.
class OracleSeesASlew : public OracleSees {};

TEST_P(OracleSeesASlew, ThatIsFaster) {
  EXPECT_THAT(findingOf(Kind::kSlew),
              ::testing::AnyOf(::testing::HasSubstr("leaps to"), ::testing::HasSubstr("changes too fast")));
}

TEST(OracleSeesOfATarget, ThatItComesIntoForceFasterThanItsSoftStart) {
  for (const std::size_t motor : {0U, 1U, 2U, 4U, 6U})
    EXPECT_THAT(findingOf({.robot = kRobotWithSlewLimits, .motor = motor, .kind = Kind::kSoftStart}),
                ::testing::HasSubstr("of its soft start"))
        << motor;
}

/// The motors whose frames tell an effort, or its bound.
class OracleSeesAnEffort : public OracleSees {};

TEST_P(OracleSeesAnEffort, BeyondItsLimit) {
  EXPECT_THAT(findingOf(Kind::kEffort), ::testing::HasSubstr("beyond its limit"));
}

/// The motors whose frames tell a speed, or its bound.
class OracleSeesASpeed : public OracleSees {};

TEST_P(OracleSeesASpeed, BeyondItsLimit) {
  EXPECT_THAT(findingOf(Kind::kSpeed), ::testing::HasSubstr("beyond its velocity limit"));
}

/// The motors whose drive does what their `on_timeout` says, and would rest without it.
class OracleSeesAFallback : public OracleSees {};

TEST_P(OracleSeesAFallback, ThatLetsGo) {
  EXPECT_THAT(findingOf(Kind::kFallback), ::testing::HasSubstr("its fallback lets go"));
}

class OracleSeesAReducedEffort : public OracleSees {};

TEST_P(OracleSeesAReducedEffort, ThatIsMore) {
  EXPECT_THAT(findingOf(Kind::kReducedEffort), ::testing::HasSubstr("reduced effort"));
}

/// The motors of the soak that have such a bound.
class OracleSeesAReducedMotor : public OracleSees {};

TEST_P(OracleSeesAReducedMotor, ThatIsToldMoreOrTurnsFaster) {
  EXPECT_THAT(findingOf(Kind::kReduced), ::testing::AnyOf(::testing::HasSubstr("faster than reduced mode"),
                                                          ::testing::HasSubstr("reduced speed")));
}

class OracleSeesAFirstAngle : public OracleSees {};

TEST_P(OracleSeesAFirstAngle, ThatIsTooFarAway) {
  EXPECT_THAT(findingOf(Kind::kFirstStep), ::testing::HasSubstr("first angle farther away"));
}

class OracleSeesATurn : public OracleSees {};

TEST_P(OracleSeesATurn, ThatIsAnother) {
  EXPECT_THAT(findingOf(Kind::kTurn), ::testing::HasSubstr("on another turn than its travel"));
}

/// The first motor of each robot.
class OracleSeesAZero : public OracleSees {};

TEST_P(OracleSeesAZero, ThatIsAnother) {
  EXPECT_THAT(findingOf(Kind::kZero), ::testing::HasSubstr("not the one that its zero was set to"));
}

/// The motors of the soak that have one.
class OracleSeesASoftLimit : public OracleSees {};

TEST_P(OracleSeesASoftLimit, ThatIsNearer) {
  EXPECT_THAT(findingOf(Kind::kSoftLimit), ::testing::HasSubstr("beyond a soft limit"));
}

/// The first motor of each family.
class OracleSeesAStranger : public OracleSees {};

TEST_P(OracleSeesAStranger, WhoseCommandsAreNoFault) {
  EXPECT_THAT(findingOf(Kind::kForeign),
              ::testing::AllOf(::testing::HasSubstr(", motor " + GetParam().motor_name + " ("),
                               ::testing::HasSubstr("somebody else commands its drive")));
}

/// The first motor of each robot.
class OracleSeesATimeout : public OracleSees {};

TEST_P(OracleSeesATimeout, ThatComesLate) {
  EXPECT_THAT(findingOf(Kind::kValidity), ::testing::HasSubstr("without a valid command"));
}

TEST(OracleSeesOfAnEstop, ThatItIsLost) {
  EXPECT_THAT(findingOf({.robot = 0, .kind = Kind::kEstop}), ::testing::HasSubstr("an e-stop was lost"));
}

/// The motors whose drive does what their `on_disable` says.
class OracleSeesADisable : public OracleSees {};

TEST_P(OracleSeesADisable, ThatLetsGo) {
  EXPECT_THAT(findingOf(Kind::kOnDisable),
              ::testing::AnyOf(::testing::HasSubstr("its fallback lets go"),
                               ::testing::HasSubstr("not that of its fallback")));
}

/// And their `on_estop`.
class OracleSeesAnEstop : public OracleSees {};

TEST_P(OracleSeesAnEstop, ThatLetsGo) {
  EXPECT_THAT(findingOf(Kind::kOnEstop), ::testing::AnyOf(::testing::HasSubstr("its fallback lets go"),
                                                          ::testing::HasSubstr("not that of its fallback")));
}

/// The motors whose drive holds, and damps afterwards.
class OracleSeesATimeOfAHold : public OracleSees {};

TEST_P(OracleSeesATimeOfAHold, ThatIsLonger) {
  EXPECT_THAT(findingOf(Kind::kFallbackTime), ::testing::HasSubstr("not that of its fallback"));
}

constexpr std::size_t kMotorThatBrakes = 0;

TEST(OracleSeesOfAFallback, ThatABrakeInAnEstopLastsLonger) {
  ASSERT_EQ(robotOf(0).buses.front().motors.at(kMotorThatBrakes).fallback.on_estop, FallbackAction::kBrake);
  EXPECT_THAT(findingOf({.robot = 0, .motor = kMotorThatBrakes, .kind = Kind::kFallbackTime}),
              ::testing::HasSubstr("not that of its fallback"));
}

constexpr std::size_t kMotorThatHolds = 4;

TEST(OracleSeesOfAFallback, ThatALoopHoldsAnotherPlace) {
  ASSERT_EQ(robotOf(0).buses.at(1).motors.at(1).fallback.on_timeout, FallbackAction::kHold);
  EXPECT_THAT(findingOf({.robot = 0, .motor = kMotorThatHolds, .kind = Kind::kHold}),
              ::testing::HasSubstr("its hold does not act"));
}

TEST(OracleSeesOfAJoint, ThatItHoldsForNobody) {
  EXPECT_THAT(findingOf({.robot = kRobotWithAJoint, .kind = Kind::kSilence}),
              ::testing::HasSubstr("holds for nobody"));
}

constexpr std::size_t kRobotWithAGroup = 0;

TEST(OracleSeesOfAGroup, ThatAMemberGoesOnWithoutTheOthers) {
  EXPECT_THAT(findingOf({.robot = kRobotWithAGroup, .motor = 4, .kind = Kind::kGroup}),
              ::testing::HasSubstr("group"));
}

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesASlew,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           const auto& shaping = motor.shaping;
                           return shaping.velocity_slew_rpm_per_s > 0.0F ||
                                  shaping.angle_slew_deg_per_s > 0.0F || shaping.effort_slew_per_s > 0.0F;
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesAReducedMotor,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           return motor.reduced.velocity_rpm > 0.0F;
                         })),
                         [](const auto& param) { return param.param.name; });

/// A Damiao drive in `control: velocity` is told a speed alone.
bool isToldAnEffort(const MotorConfig& motor) {
  const auto modes = motor.traits().modes;
  return modes.contains(ControlMode::kCurrent) || modes.contains(ControlMode::kVoltage) ||
         motor.family->name() != "Damiao" || modes.contains(ControlMode::kTotalAngle);
}

/// The loops of rc10d tell currents alone, and so do drives that follow nothing else.
bool isToldASpeed(const MotorConfig& motor) {
  const auto modes = motor.traits().modes;
  const bool follows = modes.contains(ControlMode::kVelocity) || modes.contains(ControlMode::kTotalAngle);
  return follows && motor.family->name() != "DJI" && motor.settings.velocity_limit_rpm > 0.0F;
}

/// The drive of this motor does this, and is at rest while nothing is asked of it.
bool keepsByItself(const MotorConfig& motor, FallbackAction action) {
  return action != FallbackAction::kCoast && !ofHost(motor, action) && makeWire(motor)->idlesAtRest();
}

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesAnEffort, ::testing::ValuesIn(motorsWith(isToldAnEffort)),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesASpeed, ::testing::ValuesIn(motorsWith(isToldASpeed)),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesAFallback,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           return keepsByItself(motor, motor.fallback.on_timeout);
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesADisable,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           return keepsByItself(motor, motor.fallback.on_disable);
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesAnEstop,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           return keepsByItself(motor, motor.fallback.on_estop);
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesATimeOfAHold,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           const auto& frames = motor.traits().frames;
                           return motor.fallback.on_timeout == FallbackAction::kHold &&
                                  frames.hold == Provision::kFrame && frames.damp == Provision::kFrame &&
                                  motor.fallback.hold_max <= std::chrono::seconds{2};
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesASoftLimit,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           // Without a reference it has none for most of the time.
                           const bool referenced = motor.traits().absolute || motor.settings.zero_at_power_on;
                           return referenced && std::isfinite(motor.shaping.angle_max_deg);
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesAReducedEffort,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           return motor.reduced.effort_share < 1.0F;
                         })),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesAFirstAngle,
                         ::testing::ValuesIn(motorsWith([](const MotorConfig& motor) {
                           return motor.shaping.max_first_step_deg < 180.0;
                         })),
                         [](const auto& param) { return param.param.name; });

/// Its travel, of less than a turn, tells the turn.
bool knowsItsTurn(const MotorConfig& motor) {
  const auto traits = motor.traits();
  const auto& settings = motor.settings;
  const bool own_gear = settings.gear_ratio <= 0.0 || settings.gear_ratio == traits.gear_ratio;
  return traits.absolute && own_gear && !settings.zero_at_power_on &&
         motor.shaping.angle_max_deg - motor.shaping.angle_min_deg < 360.0;
}

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSeesATurn, ::testing::ValuesIn(motorsWith(knowsItsTurn)),
                         [](const auto& param) { return param.param.name; });

std::vector<Case> firstMotors() {
  auto cases = everyMotor();
  std::erase_if(cases, [](const Case& each) { return each.motor != 0; });
  return cases;
}

std::vector<Case> firstOfFamilies() {
  std::set<std::string> seen;
  return motorsWith([&seen](const MotorConfig& motor) { return seen.emplace(motor.family->name()).second; });
}

INSTANTIATE_TEST_SUITE_P(EachFamily, OracleSeesAStranger, ::testing::ValuesIn(firstOfFamilies()),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachRobot, OracleSeesATimeout, ::testing::ValuesIn(firstMotors()),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachRobot, OracleSeesAZero, ::testing::ValuesIn(firstMotors()),
                         [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSees, ::testing::ValuesIn(everyMotor()),
                         [](const auto& param) { return param.param.name; });

}  // namespace oracle_test
}  // namespace rc10::test
