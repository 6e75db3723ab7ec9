// LKTech_Motor, LKTech_Group and their simulated drives, frame by frame in virtual time.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_group.hpp"
#include "drives/lktech/lktech_motor.hpp"
#include "drives/lktech/lktech_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::lktech_closed_loop_test {
namespace {

using namespace std::chrono_literals;

struct Variation {
  std::string model = "LK-MF9025";
  double gear_ratio = 0.0;
  int direction = 1;
  int command_divider = 1;
  double zero_deg = 0.0;
  int encoder_bits = 16;
  float initial_angle_deg = 30.0F;
};

MotorSettings settingsOf(const Variation& variation, int id = 3) {
  MotorSettings settings;
  settings.name = "motor" + std::to_string(id);
  settings.model = variation.model;
  settings.id = id;
  settings.gear_ratio = variation.gear_ratio;
  settings.direction = variation.direction;
  settings.command_divider = variation.command_divider;
  settings.zero_deg = variation.zero_deg;
  settings.own = ownDefaults(lktechFamily());
  settings.own.set("encoder_bits", static_cast<double>(variation.encoder_bits));
  return settings;
}

SoloRig rigOf(const Variation& variation) {
  const auto settings = settingsOf(variation);
  const auto traits = lktechFamily().traits(settings.model, settings.own);
  sim::MotorLoad load;
  load.initial_angle_deg = variation.initial_angle_deg;
  return SoloRig(std::make_unique<LKTech_Motor>(settings, traits), sim::makeLktechDrive(settings, load));
}

class LKTechLoop : public testing::TestWithParam<Variation> {};

TEST_P(LKTechLoop, EveryModeReachesItsTarget) {
  SoloRig rig = rigOf(GetParam());
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  EXPECT_LT(rig.currentA(), 0.02) << "enabling gives no torque";
  ASSERT_TRUE(rig.motor().setZero(0.0));
  const auto& feedback = rig.motor().feedback();

  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(1s);
  EXPECT_NEAR(feedback.velocity_rpm, 40.0, 0.5);
  rig.command({.mode = ControlMode::kTotalAngle, .value = 800.0});
  rig.run(5s);
  EXPECT_NEAR(feedback.total_angle_deg, 800.0, 0.3);
  rig.command({.mode = ControlMode::kAngle, .value = 10.0});
  rig.run(2s);
  EXPECT_NEAR(feedback.total_angle_deg, 730.0, 0.3) << "the short way";
  rig.command({.mode = ControlMode::kCurrent, .value = 0.5});
  rig.run(30ms);
  EXPECT_NEAR(feedback.current_a, 0.5, 0.05);
  EXPECT_GT(feedback.velocity_rpm, 0.0) << "a positive current drives it in the positive direction";
  rig.command({.mode = ControlMode::kBrake});
  rig.run(1s);
  EXPECT_NEAR(feedback.velocity_rpm, 0.0, 0.5);
  const double here_deg = feedback.total_angle_deg;
  rig.motor().order(FrameKind::kHold);
  rig.run(500ms);
  EXPECT_NEAR(feedback.total_angle_deg, here_deg, 0.5);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST_P(LKTechLoop, RestAndPollLeaveNoTorqueWhateverItDidBefore) {
  expectNoTorqueAtRestAndPoll([] { return rigOf(GetParam()); },
                              {.mode = ControlMode::kVelocity, .value = 40.0});
}

INSTANTIATE_TEST_SUITE_P(Variations, LKTechLoop,
                         testing::Values(Variation{}, Variation{.direction = -1},
                                         Variation{.gear_ratio = 2.5}, Variation{.command_divider = 4},
                                         Variation{.encoder_bits = 14}, Variation{.model = "LK-MG5010E-i10"},
                                         Variation{.model = "LK-MG5010E-i36"}),
                         [](const auto& each) { return "case" + std::to_string(each.index); });

TEST(LKTechDriveLoop, TheAngleIsKnownFromTheStart) {
  SoloRig rig = rigOf({.model = "LK-MG5010E-i10", .zero_deg = 20.0});
  rig.comeOnline();
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 10.0, 0.02);
}

TEST(LKTechDriveLoop, AnErrorStaysUntilItIsClearedAndThenItCanBeEnabledAgain) {
  SoloRig rig = rigOf({});
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(300ms);
  rig.drive().fault(0x08);
  rig.run(150ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveMotorTooHot);
  rig.motor().order(FrameKind::kPoll);
  rig.run(10ms);
  rig.motor().clearComplaint();
  rig.run(150ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveMotorTooHot) << "its cause is still there";
  EXPECT_FALSE(rig.enable());
  rig.drive().fault(0);
  rig.motor().order(FrameKind::kPoll);
  rig.run(150ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveMotorTooHot) << "latched";
  rig.motor().clearComplaint();
  rig.run(150ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(1s);
  EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 40.0, 0.5);
}

TEST(LKTechDriveLoop, ADriveThatForgotItsTurnsNeverRunsBackToThem) {
  SoloRig rig = rigOf({});
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.motor().setZero(0.0));
  rig.command({.mode = ControlMode::kTotalAngle, .value = 1000.0});
  rig.run(5s);
  rig.drive().restart();
  const double before_deg = rig.drive().physics().outputAngleDeg();
  rig.run(700ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), before_deg, 1.0);
  rig.motor().order(FrameKind::kPoll);
  rig.run(50ms);
  rig.motor().clearComplaint();
  EXPECT_TRUE(rig.enable());
}

TEST(LKTechDriveLoop, ADriveThatSomebodyTurnedOffIsNoticedAndEnablingTurnsItOn) {
  SoloRig rig = rigOf({});
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(300ms);
  rig.drive().receive(lktech::request(3, lktech::Code::kOff));
  rig.run(200ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  rig.motor().order(FrameKind::kPoll);
  rig.run(100ms);
  rig.motor().clearComplaint();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(1s);
  EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 40.0, 0.5);
}

TEST(LKTechDriveLoop, EnablingFailsWhenNobodyAnswers) {
  SoloRig rig = rigOf({});
  rig.cut(true);
  EXPECT_FALSE(rig.enable());
}

TEST(LKTechGroupLoop, FourDrivesRunFromOneFrame) {
  LKTech_Group group;
  std::vector<std::unique_ptr<LKTech_Motor>> motors;
  std::vector<std::unique_ptr<sim::Drive>> drives;
  for (int id = 1; id <= 4; ++id) {
    auto settings = settingsOf({}, id);
    settings.own.set("group", 1.0);
    motors.push_back(
        std::make_unique<LKTech_Motor>(settings, lktechFamily().traits(settings.model, settings.own)));
    drives.push_back(sim::makeLktechDrive(settings, {}));
    ASSERT_TRUE(group.registerMotor(*motors.back()));
  }
  MonotonicTime now{1h};
  std::uint64_t index = 0;
  std::size_t group_frames = 0;
  const auto run = [&](int ms) {
    for (int i = 0; i < ms; ++i, now += 1ms) {
      const Tick tick{.index = ++index, .now = now, .dt_s = 0.001F};
      std::vector<CanFrame> bus;
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      for (auto& motor : motors) {
        motor->update(tick);
        const auto count = motor->packCommand(tick, out);
        bus.insert(bus.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
      }
      const auto count = group.packCommand(tick, out);
      group_frames += count;
      bus.insert(bus.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
      for (auto& drive : drives) {
        for (const auto& frame : bus) drive->receive(frame);
        drive->step(1ms);
        std::array<CanFrame, sim::Drive::kMaxFrames> answers{};
        const auto answered = drive->answers(answers);
        for (auto& frame : std::span(answers).first(answered)) {
          frame.received = now + 500us;
          for (auto& motor : motors) {
            if (motor->matchesFrame(frame)) (void)motor->updateFeedback(frame);
          }
        }
      }
    }
  };
  for (auto& motor : motors) motor->order(FrameKind::kPoll);
  run(100);
  for (auto& motor : motors) motor->order(FrameKind::kEnable);
  run(100);
  for (auto& motor : motors) EXPECT_EQ(motor->sequenceProgress(), SequenceProgress::kDone);
  for (std::size_t i = 0; i < motors.size(); ++i) {
    motors[i]->order(FrameKind::kCommand);
    ASSERT_TRUE(
        motors[i]->setTarget({.mode = ControlMode::kCurrent, .value = 0.5 * (static_cast<double>(i) - 1.5)}));
  }
  group_frames = 0;
  run(50);
  EXPECT_EQ(group_frames, 50U) << "one frame for all four";
  for (std::size_t i = 0; i < motors.size(); ++i) {
    EXPECT_NEAR(motors[i]->feedback().current_a, 0.5 * (static_cast<double>(i) - 1.5), 0.05);
    EXPECT_GT(motors[i]->feedback().velocity_rpm * (static_cast<float>(i) - 1.5F), 0.0F);
  }
  motors[0]->order(FrameKind::kPoll);
  run(20);
  EXPECT_NEAR(drives[0]->physics().currentA(), 0.0, 0.02);
  EXPECT_GT(std::abs(drives[3]->physics().currentA()), 0.3) << "the others run on";
}

}  // namespace
}  // namespace rc10::test::lktech_closed_loop_test
