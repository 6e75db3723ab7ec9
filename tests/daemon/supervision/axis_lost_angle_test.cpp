// A stream of angles on a shaft without a travel, several turns from where it was switched on, whose feedback
// has a gap: it goes on, and the shaft turns no way of its own, in each family with an absolute encoder.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>

#include "daemon/supervision/absolute_encoders.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::axis_lost_angle_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kArm = 0;
constexpr double kFarDeg = 500.0;

enum class Gap { kDriveSilent, kComputerPauses, kDriveRestarts };

struct Loss {
  const char* name;
  Gap gap;
  int ticks;
};

void PrintTo(const Loss& loss, std::ostream* out) { *out << loss.name; }

constexpr Loss kSilence{"Silence", Gap::kDriveSilent, 150};
constexpr Loss kOffline{"Offline", Gap::kDriveSilent, 1200};
constexpr Loss kLongPause{"LongPause", Gap::kComputerPauses, 250};
constexpr Loss kRestart{"Restart", Gap::kDriveRestarts, 3};
constexpr Loss kRestartOffline{"RestartOffline", Gap::kDriveRestarts, 1200};
constexpr Loss kLosses[] = {{"Short", Gap::kDriveSilent, 35},
                            kSilence,
                            {"LongSilence", Gap::kDriveSilent, 380},
                            kOffline,
                            {"Pause", Gap::kComputerPauses, 60},
                            kLongPause,
                            kRestart,
                            {"RestartSilent", Gap::kDriveRestarts, 300},
                            kRestartOffline};

class LostAngle : public ::testing::TestWithParam<std::tuple<AbsoluteEncoder, Loss>> {
 protected:
  void start(FallbackAction on_timeout, bool joint = false) {
    joint_ = joint;
    auto config =
        robotOfArm(subject(), ", feedback_timeout_ms: 400", sign() * zero(),
                   joint ? "modules:\n  - {name: lift, type: joint, motor: motor, max_velocity_deg_s: "
                           "400, max_acceleration_deg_s2: 2000}\n"
                         : "");
    auto& arm = config.buses[0].motors[0];
    const bool damps = arm.traits().frames.damp != Provision::kUnsupported;
    arm.fallback.on_timeout =
        on_timeout == FallbackAction::kDamp && !damps ? FallbackAction::kBrake : on_timeout;
    robot_ = std::make_unique<VirtualRobot>(config);
    for (int i = 0; i < 4000 && robot_->motor(kArm).status != MotorStatus::kReady; ++i) robot_->run(1);
    enable();
    ASSERT_NEAR(shaftDeg(), 0.0, 1.0);
    for (double deg = 0.0; deg < kFarDeg; deg += 0.5) stream(deg);
    for (int i = 0; i < 800; ++i) stream(kFarDeg);
    ASSERT_NEAR(shaftDeg(), kFarDeg, 5.0);
    ASSERT_NEAR(totalDeg(), shaftDeg(), 1.0);
  }
  void enable() {
    for (int i = 0; i < 12 && robot_->motor(kArm).status != MotorStatus::kActive; ++i) {
      (void)robot_->order(Operation::kClear);
      (void)robot_->order(Operation::kEnable);
      for (int k = 0; k < 500; ++k) stream(asked_deg_);
    }
    ASSERT_EQ(robot_->motor(kArm).status, MotorStatus::kActive);
  }
  /// The message of a tick, from a client that does not look, and the tick.
  void stream(double deg, std::uint64_t periods = 1) {
    asked_deg_ = deg;
    if (joint_) {
      robot_->giveInputs({deg}, 500ms);
    } else {
      robot_->command(kArm, {.mode = ControlMode::kTotalAngle, .value = deg}, 500ms);
    }
    robot_->tick(periods);
    if (watched_) farthest_deg_ = std::max(farthest_deg_, std::fabs(shaftDeg() - kFarDeg));
  }
  void lose() {
    const auto& loss = std::get<Loss>(GetParam());
    watched_ = true;
    if (loss.gap == Gap::kComputerPauses) return stream(kFarDeg, static_cast<std::uint64_t>(loss.ticks));
    const bool restarts = loss.gap == Gap::kDriveRestarts;
    if (restarts) robot_->simBus().drive(0).restart();
    // A drive without power hears nothing, either.
    restarts ? robot_->freezeBus(0, true) : robot_->simBus().silence(0, true);
    for (int i = 0; i < loss.ticks; ++i) {
      stream(kFarDeg);
      if (restarts) (void)robot_->takeFrames();
    }
    restarts ? robot_->freezeBus(0, false) : robot_->simBus().silence(0, false);
  }
  /// It goes on, and somebody enables it anew where it is not ACTIVE any more.
  void goOn() {
    for (int i = 0; i < 1500; ++i) stream(kFarDeg);
    const auto& feedback = robot_->motor(kArm).feedback;
    EXPECT_TRUE(feedback.zeroed || feedback.bounds_only) << "found by itself";
    // The count of a RobStride is in doubt until it is enabled anew.
    if (feedback.bounds_only) (void)robot_->order(Operation::kDisable);
    enable();
    for (int i = 0; i < 1000; ++i) stream(kFarDeg);
    EXPECT_LT(farthest_deg_, 180.0);
    EXPECT_TRUE(robot_->motor(kArm).feedback.zeroed);
    EXPECT_NEAR(totalDeg(), shaftDeg(), 1.0);
    EXPECT_NEAR(shaftDeg(), kFarDeg, 5.0) << "it is followed again";
  }
  void loseUnder(FallbackAction on_timeout, bool joint = false) {
    start(on_timeout, joint);
    lose();
    goOn();
  }

  static const AbsoluteEncoder& subject() { return std::get<AbsoluteEncoder>(GetParam()); }
  static bool reversed() {
    return std::string_view{subject().motor}.find("direction") != std::string_view::npos;
  }
  static double sign() { return reversed() ? -1.0 : 1.0; }
  static double zero() { return reversed() ? 70.0 : 0.0; }
  double shaftDeg() {
    return sign() * robot_->simBus().drive(0).physics().outputAngleDeg() - zero() - subject().parked_deg;
  }
  double totalDeg() { return robot_->motor(kArm).feedback.total_angle_deg; }

  std::unique_ptr<VirtualRobot> robot_;
  bool joint_ = false;
  bool watched_ = false;
  double asked_deg_ = 0.0;
  double farthest_deg_ = 0.0;  ///< From where the loss found it.
};

/// Each with the losses that differ from one another under it.
class LostWhenHeld : public LostAngle {};
class LostWhenDamped : public LostAngle {};
class LostUnderAJoint : public LostAngle {};
class LostInMotion : public LostAngle {};

TEST_P(LostAngle, TurnsNoWholeTurnsUnderAStreamThatGoesOn) { loseUnder(FallbackAction::kCoast); }

// Its wraps are asked for and known some ticks after the hold has begun.
TEST_P(LostInMotion, HoldsWhereTheGapHasLeftIt) {
  start(FallbackAction::kHold);
  for (int i = 0; i < 200; ++i) robot_->hold(kArm, {.mode = ControlMode::kVelocity, .value = 60.0}, 1);
  robot_->simBus().silence(0, true);
  robot_->hold(kArm, {.mode = ControlMode::kVelocity, .value = 60.0}, 110);
  robot_->run(60);  // the target lapses, and the hold begins, before it is heard again
  robot_->simBus().silence(0, false);
  robot_->run(1000);
  EXPECT_TRUE(robot_->motor(kArm).feedback.zeroed);
  EXPECT_NEAR(totalDeg(), shaftDeg(), 1.0);
  EXPECT_GT(shaftDeg(), kFarDeg + 60.0 * 6.0 * 0.3) << "not pulled back by the way of the gap";
}

TEST_P(LostWhenHeld, TurnsNoWholeTurnsAfterIt) { loseUnder(FallbackAction::kHold); }

TEST_P(LostWhenDamped, TurnsNoWholeTurnsAfterIt) { loseUnder(FallbackAction::kDamp); }

TEST_P(LostUnderAJoint, TurnsNoWholeTurnsThatItsProfileWouldLead) { loseUnder(FallbackAction::kCoast, true); }

AbsoluteEncoder encoderOf(std::string_view name) {
  return *std::find_if(std::begin(kAbsoluteEncoders), std::end(kAbsoluteEncoders),
                       [name](const AbsoluteEncoder& each) { return each.name == name; });
}

// A motor that is held is enabled without the sequence, so that its count is not asked for.
TEST(LostAngleOfARobStride, StaysInDoubtThroughAHoldAndEndsWithTheDisableThatLetsGo) {
  auto config = robotOfArm(encoderOf("RobStride"), ", feedback_timeout_ms: 400, on_disable: hold", 0.0, "");
  VirtualRobot robot(config);
  const auto expectOnceEnabled = [&robot](bool zeroed) {
    for (int i = 0; i < 4 && robot.motor(kArm).status != MotorStatus::kActive; ++i) {
      (void)robot.order(Operation::kEnable);
      robot.run(500);
    }
    ASSERT_EQ(robot.motor(kArm).status, MotorStatus::kActive);
    EXPECT_EQ(robot.motor(kArm).feedback.zeroed, zeroed);
  };
  const auto expectOnceDisabled = [&robot](int times, Acting acting) {
    for (int i = 0; i < times; ++i) (void)robot.order(Operation::kDisable);
    robot.run(50);
    ASSERT_EQ(robot.motor(kArm).acting, acting);
  };
  robot.run(500);
  expectOnceEnabled(true);
  robot.simBus().silence(0, true);
  robot.run(230);
  robot.simBus().silence(0, false);
  robot.run(50);
  expectOnceEnabled(false);
  expectOnceDisabled(1, Acting::kHold);
  expectOnceEnabled(false);
  expectOnceDisabled(2, Acting::kNothing);
  expectOnceEnabled(true);
}

constexpr AbsoluteEncoder kManyWrapsAway[] = {
    {"DamiaoFar", "model: DM4310, id: 1, master_id: 17, control: position_velocity", 47 * 360.0}};

std::string nameOf(const ::testing::TestParamInfo<LostAngle::ParamType>& each) {
  return std::string{std::get<0>(each.param).name} + std::get<1>(each.param).name;
}

using ::testing::Combine;
using ::testing::Values;
using ::testing::ValuesIn;

INSTANTIATE_TEST_SUITE_P(Families, LostAngle, Combine(ValuesIn(kAbsoluteEncoders), ValuesIn(kLosses)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Far, LostAngle, Combine(ValuesIn(kManyWrapsAway), ValuesIn(kLosses)), nameOf);
INSTANTIATE_TEST_SUITE_P(Families, LostWhenHeld,
                         Combine(ValuesIn(kAbsoluteEncoders),
                                 Values(kSilence, kOffline, kLongPause, kRestart)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Families, LostInMotion,
                         Combine(Values(encoderOf("Damiao"), encoderOf("DamiaoReversed")), Values(kSilence)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Families, LostWhenDamped, Combine(ValuesIn(kAbsoluteEncoders), Values(kSilence)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Families, LostUnderAJoint,
                         Combine(ValuesIn(kAbsoluteEncoders), Values(kLongPause, kOffline, kRestartOffline)),
                         nameOf);

}  // namespace
}  // namespace rc10::test::axis_lost_angle_test
