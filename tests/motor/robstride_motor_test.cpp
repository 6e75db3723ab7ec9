#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/socket_pair.hpp"
#include "drives/robstride/robstride_family.hpp"
#include "support/alloc_guard.hpp"
#include "support/robstride_settings.hpp"

namespace rc10::test::robstride_motor_test {
namespace {

using std::chrono::milliseconds;
constexpr int kDrive = 127;
constexpr int kHost = 253;

std::uint32_t typeOf(const CanFrame& frame) { return frame.id.value >> 24U; }

/// One motor, and a drive that says what the test says.
class Bench {
 public:
  explicit Bench(const MotorSettings& settings)
      : motor(settings),
        codec{.model = findRobstrideModel(settings.model),
              .position_range_rad = findRobstrideModel(settings.model)->position_range_rad,
              .drive_id = settings.id,
              .host_id = kHost} {}

  std::vector<CanFrame> tick(FrameKind kind, const Target& target = {}) {
    motor.order(kind, target);
    return tick();
  }
  std::vector<CanFrame> tick() {
    now += milliseconds{1};
    const Tick at{.index = ++ticks, .now = now, .dt_s = 0.001F};
    motor.update(at);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor.packCommand(at, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  FrameVerdict say(robstride::Feedback state) {
    auto frame = codec.answer(state);
    frame.received = now;
    return motor.updateFeedback(frame);
  }
  FrameVerdict run(double position_rad = 0.0, double velocity_rad_s = 0.0) {
    return say({.position_rad = position_rad, .velocity_rad_s = velocity_rad_s, .mode = robstride::kRunning});
  }
  FrameVerdict parameter(std::uint16_t index, std::uint32_t bits, bool known = true) {
    auto frame = codec.parameter(index, bits, known);
    frame.received = now;
    return motor.updateFeedback(frame);
  }
  robstride::Operation operation(const Target& target) {
    for (const auto& frame : tick(FrameKind::kCommand, target)) {
      if (typeOf(frame) == 1) return codec.operation(frame);
    }
    ADD_FAILURE() << "no command of the operation mode";
    return {};
  }

  RobStride_Motor motor;
  robstride::Codec codec;
  MonotonicTime now{std::chrono::hours{1}};
  std::uint64_t ticks = 0;
};

MotorSettings controlled(std::string control, std::string_view model = "RS00") {
  auto settings = robStrideSettings(model);
  settings.own.set("control", std::move(control));
  return settings;
}

double torqueOf(const robstride::Operation& told, double position_rad, double velocity_rad_s) {
  return told.stiffness_nm_per_rad * (told.position_rad - position_rad) +
         told.damping_nms_per_rad * (told.velocity_rad_s - velocity_rad_s) + told.torque_nm;
}

// --- Rest, poll, rhythm

TEST(RobStrideMotor, RestIsAStopFromTheFirstTickOnAndNeedsNoFeedback) {
  RobStride_Motor motor(robStrideSettings("RS03", 5));
  std::array<CanFrame, 4> out{};
  out[0].data.fill(0xFF);
  ASSERT_EQ(motor.packRest(out), 2U);
  EXPECT_EQ(out[0].id.value, 0x0400FD05U);
  EXPECT_EQ(out[0].length, 8);
  for (const auto byte : out[0].payload()) EXPECT_EQ(byte, 0);
  EXPECT_EQ(out[1].id, motor.commandIds().front());  // whose echo is watched
  EXPECT_EQ(motor.packRest(std::span{out}.first(1)), 1U);
}

TEST(RobStrideMotor, TheWatchedIdIsSentInEveryState) {
  for (const auto kind : {FrameKind::kPoll, FrameKind::kIdle, FrameKind::kCommand, FrameKind::kRest}) {
    Bench bench(robStrideSettings("RS00"));
    bench.run();
    int watched = 0;
    for (int i = 0; i < 200; ++i) {
      for (const auto& frame : bench.tick(kind)) {
        if (frame.id == bench.motor.commandIds().front()) ++watched;
      }
    }
    EXPECT_EQ(watched, 5);
  }
}

TEST(RobStrideMotor, PollingStopsAndNowAndThenReadsTheSupplyVoltage) {
  Bench bench(robStrideSettings("RS00"));
  int stops = 0;
  int reads = 0;
  for (int i = 0; i < 100; ++i) {
    for (const auto& frame : bench.tick(FrameKind::kPoll)) {
      if (typeOf(frame) == 4) ++stops;
      if (typeOf(frame) == 17) ++reads;
    }
  }
  EXPECT_EQ(stops, 100);
  EXPECT_EQ(reads, 3);
}

TEST(RobStrideMotor, TheDividerThinsOutWhatIsSent) {
  auto settings = robStrideSettings("RS00");
  settings.command_divider = 4;
  settings.command_phase = 3;
  Bench bench(settings);
  for (int i = 1; i <= 40; ++i) EXPECT_EQ(bench.tick(FrameKind::kPoll).empty(), i % 4 != 3) << i;
}

// --- Commands in operation mode

TEST(RobStrideMotor, IdleIsAFrameWithoutAnyTorque) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(0.5, 3.0);
  const auto frames = bench.tick(FrameKind::kIdle);
  ASSERT_FALSE(frames.empty());
  const auto told = bench.codec.operation(frames[0]);
  EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
  EXPECT_EQ(told.damping_nms_per_rad, 0.0);
  EXPECT_NEAR(told.torque_nm, 0.0, 14.0 / 65535);
}

TEST(RobStrideMotor, ACurrentBecomesTheTorqueOfItsTorqueConstant) {
  Bench bench(robStrideSettings("CyberGear"));
  const auto told = bench.operation({.mode = ControlMode::kCurrent, .value = 4.0});
  EXPECT_NEAR(told.torque_nm, 4.0 * 0.87 / std::numbers::sqrt2, 1e-3);
  EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
  EXPECT_NEAR(bench.motor.commandValue(), 4.0F, 1e-3F);
  EXPECT_EQ(bench.motor.commandUnit(), CommandUnit::kAmpere);
}

TEST(RobStrideMotor, ImpedanceArrivesInTheDrivesOwnMeasure) {
  auto settings = robStrideSettings("RS00");
  settings.gear_ratio = 20.0;  // twice its own
  settings.direction = -1;
  Bench bench(settings);
  bench.run();
  const auto told = bench.operation({.mode = ControlMode::kImpedance,
                                     .value = bench.motor.feedback().total_angle_deg + 2.0,
                                     .velocity_ff_rpm = 3.0F,
                                     .torque_ff_nm = 1.0F,
                                     .stiffness_nm_per_rad = 40.0F,
                                     .damping_nms_per_rad = 4.0F});
  EXPECT_NEAR(told.position_rad, -4.0 / kDegPerRad, 1e-3);
  EXPECT_NEAR(told.velocity_rad_s, -6.0 / kRpmPerRadPerS, 2e-3);
  EXPECT_NEAR(told.stiffness_nm_per_rad, 10.0, 0.01);
  EXPECT_NEAR(told.damping_nms_per_rad, 1.0, 1e-3);
  EXPECT_NEAR(told.torque_nm, -0.5, 1e-3);
}

TEST(RobStrideMotor, TheTorqueStaysWithinTheLimitWhereverTheTargetIs) {
  for (const std::string_view model : {"RS00", "RS04", "EL05", "CyberGear"}) {
    auto settings = robStrideSettings(model);
    settings.effort_limit = 2.0F;
    Bench bench(settings);
    const double limit_nm = 2.0 * bench.codec.model->torqueNmPerA();
    const double lsb_nm = 2.5 * bench.codec.model->torque_range_nm / 65535;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int i = 0; i < 2000; ++i) {
      // As the motor reads them.
      const auto seen = bench.codec.feedback(
          bench.codec.answer({.position_rad = 6.0 * any(random), .velocity_rad_s = 5.0 * any(random)}));
      const double position_rad = seen.position_rad;
      const double velocity_rad_s = seen.velocity_rad_s;
      bench.motor.order(FrameKind::kPoll);
      bench.run(position_rad, velocity_rad_s);
      bench.tick(FrameKind::kEnable);  // ends any doubt about jumps
      Target target{.mode = static_cast<ControlMode>(1 + i % 5), .value = 360.0 * any(random)};
      target.torque_ff_nm = static_cast<float>(10.0 * any(random));
      target.stiffness_nm_per_rad = static_cast<float>(50.0 + 50.0 * any(random));
      target.damping_nms_per_rad = static_cast<float>(1.0 + any(random));
      const auto told = bench.operation(target);
      // The raw position counts for as much as the stiffness makes of it.
      const double slack_nm = lsb_nm + 0.001 * told.stiffness_nm_per_rad + 0.004 * told.damping_nms_per_rad;
      EXPECT_LE(std::abs(torqueOf(told, position_rad, velocity_rad_s)), limit_nm + slack_nm)
          << model << " " << i;
    }
    EXPECT_NE(bench.motor.limits() & kLimitCurrent, 0U);
  }
}

TEST(RobStrideMotor, DeratingScalesTheTorque) {
  Bench bench(robStrideSettings("RS00"));
  bench.motor.derate(0.25F);
  const auto told = bench.operation({.mode = ControlMode::kCurrent, .value = 100.0});
  EXPECT_NEAR(told.torque_nm, 14.0 / 4, 0.05);
  EXPECT_NE(bench.motor.limits() & kLimitCurrent, 0U);
}

TEST(RobStrideMotor, AVelocityTargetIsCutOffAtTheLimit) {
  auto settings = robStrideSettings("RS00");
  settings.velocity_limit_rpm = 60.0F;
  Bench bench(settings);
  bench.run(0.0, 60.0 / kRpmPerRadPerS);
  const auto told = bench.operation({.mode = ControlMode::kVelocity, .value = -1e9});
  EXPECT_NE(bench.motor.limits() & kLimitVelocity, 0U);
  EXPECT_GE(told.velocity_rad_s, -60.0 / kRpmPerRadPerS - 1e-2);
}

TEST(RobStrideMotor, AnAngleTargetIsNotApproachedFasterThanTheLimit) {
  auto settings = robStrideSettings("RS00");
  settings.velocity_limit_rpm = 30.0F;
  Bench bench(settings);
  bench.run(0.0, 30.0 / kRpmPerRadPerS);
  const auto told = bench.operation({.mode = ControlMode::kTotalAngle, .value = 300.0});
  EXPECT_NEAR(torqueOf(told, 0.0, 30.0 / kRpmPerRadPerS), 0.0, 0.02);  // at the limit nothing pushes any more
  EXPECT_NE(bench.motor.limits() & kLimitVelocity, 0U);
}

TEST(RobStrideMotor, DampAndBrakeResistTheMotion) {
  Bench bench(robStrideSettings("RS03"));
  bench.run(0.0, 2.0);
  const auto damp = bench.codec.operation(bench.tick(FrameKind::kDamp)[0]);
  const auto brake = bench.codec.operation(bench.tick(FrameKind::kBrake)[0]);
  EXPECT_LT(torqueOf(damp, 0.0, 2.0), 0.0);
  EXPECT_LT(torqueOf(brake, 0.0, 2.0), torqueOf(damp, 0.0, 2.0));
}

TEST(RobStrideMotor, HoldStaysWhereItBegan) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(1.0);
  EXPECT_NEAR(bench.codec.operation(bench.tick(FrameKind::kHold)[0]).position_rad, 1.0, 1e-3);
  bench.run(1.05);
  EXPECT_NEAR(bench.codec.operation(bench.tick(FrameKind::kHold)[0]).position_rad, 1.0, 1e-3);
}

TEST(RobStrideMotor, WithoutFeedbackNothingThatDependsOnItIsSent) {
  Bench bench(robStrideSettings("RS00"));
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kTotalAngle, ControlMode::kImpedance}) {
    const auto told = bench.operation({.mode = mode, .value = 10.0, .stiffness_nm_per_rad = 50.0F});
    EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
    EXPECT_EQ(told.damping_nms_per_rad, 0.0);
  }
}

TEST(RobStrideMotor, InputThatIsNoNumberIsHarmless) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const std::string control : {"operation", "current", "velocity", "position"}) {
    Bench bench(controlled(control));
    bench.run(0.2, 1.0);
    for (const double value : {kNan, kInf, -kInf, 1e308, -1e308}) {
      for (int mode = 0; mode < kControlModeCount; ++mode) {
        Target target{.mode = static_cast<ControlMode>(mode), .value = value};
        target.torque_ff_nm = target.velocity_ff_rpm = static_cast<float>(value);
        target.stiffness_nm_per_rad = target.damping_nms_per_rad = static_cast<float>(value);
        for (const auto& frame : bench.tick(FrameKind::kCommand, target)) {
          EXPECT_TRUE(isValidLength(false, frame.length));
          EXPECT_LE(frame.id.value, kExtendedIdMask);
          if (typeOf(frame) == 18) {
            EXPECT_TRUE(std::isfinite(readLittleEndian<float>(frame.payload(), 4)));
          }
          if (typeOf(frame) == 1) {
            EXPECT_LE(std::abs(torqueOf(bench.codec.operation(frame), 0.2, 1.0)), 14.1);
          }
        }
        EXPECT_TRUE(std::isfinite(bench.motor.commandValue()) || std::abs(value) > 1e30);
      }
    }
  }
}

TEST(RobStrideMotor, EveryValueOnTheScalesComesBack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (const auto& model : robstrideModels()) {
    const robstride::Codec codec{.model = &model,
                                 .position_range_rad = model.position_range_rad,
                                 .drive_id = kDrive,
                                 .host_id = kHost};
    for (int i = 0; i < 500; ++i) {
      const robstride::Operation wanted{
          .position_rad = share(random) * model.position_range_rad,
          .velocity_rad_s = share(random) * model.velocity_range_rad_s,
          .stiffness_nm_per_rad = std::abs(share(random)) * model.stiffness_range_nm_per_rad,
          .damping_nms_per_rad = std::abs(share(random)) * model.damping_range_nms_per_rad,
          .torque_nm = share(random) * model.torque_range_nm};
      const auto told = codec.operation(codec.operate(wanted));
      EXPECT_NEAR(told.position_rad, wanted.position_rad, 2 * model.position_range_rad / 65535);
      EXPECT_NEAR(told.velocity_rad_s, wanted.velocity_rad_s, 2 * model.velocity_range_rad_s / 65535);
      EXPECT_NEAR(told.stiffness_nm_per_rad, wanted.stiffness_nm_per_rad,
                  model.stiffness_range_nm_per_rad / 65535);
      EXPECT_NEAR(told.damping_nms_per_rad, wanted.damping_nms_per_rad,
                  model.damping_range_nms_per_rad / 65535);
      EXPECT_NEAR(told.torque_nm, wanted.torque_nm, 2 * model.torque_range_nm / 65535);
    }
  }
}

// --- Run modes

TEST(RobStrideMotor, TheCurrentModeWritesItsReference) {
  auto settings = controlled("current");
  settings.direction = -1;
  settings.effort_limit = 5.0F;
  Bench bench(settings);
  const auto frames = bench.tick(FrameKind::kCommand, {.mode = ControlMode::kCurrent, .value = 9.0});
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kCurrentRef);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[0].payload(), 4), -5.0F);
  EXPECT_NE(bench.motor.limits() & kLimitCurrent, 0U);
  EXPECT_FLOAT_EQ(bench.motor.commandValue(), 5.0F);
}

TEST(RobStrideMotor, TheVelocityModeHasNoCurrentUntilThereIsATarget) {
  Bench bench(controlled("velocity"));
  bench.run();
  auto frames = bench.tick(FrameKind::kIdle);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[0].payload(), 4), 0.0F);
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[1].payload(), 0), robstride::parameter::kCurrentLimit);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[1].payload(), 4), 0.0F);
  frames = bench.tick(FrameKind::kCommand, {.mode = ControlMode::kVelocity, .value = 60.0});
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kVelocityRef);
  EXPECT_NEAR(readLittleEndian<float>(frames[0].payload(), 4), 60.0 / kRpmPerRadPerS, 1e-4);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[1].payload(), 4), 15.5F);
  EXPECT_EQ(typeOf(bench.tick()[0]), 18U);
}

TEST(RobStrideMotor, ThePositionModeGoesBeyondTheScaleOfFeedback) {
  Bench bench(controlled("position"));
  bench.run(1.0);
  const auto frames = bench.tick(
      FrameKind::kCommand,
      {.mode = ControlMode::kTotalAngle, .value = bench.motor.feedback().total_angle_deg + 3600.0});
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kPositionRef);
  EXPECT_NEAR(readLittleEndian<float>(frames[0].payload(), 4), 1.0 + 20 * std::numbers::pi, 1e-3);
}

// --- Feedback

TEST(RobStrideMotor, TurnsAreCountedAcrossTheEndOfTheScale) {
  Bench bench(robStrideSettings("RS00"));
  const double range = 4 * std::numbers::pi;
  for (double position_rad = 0.0; position_rad < 60.0; position_rad += 0.1) {
    bench.tick(FrameKind::kPoll);
    const double shown = std::remainder(position_rad, 2 * range);
    bench.run(shown);
    EXPECT_NEAR(bench.motor.feedback().total_angle_deg, position_rad * kDegPerRad, 0.05);
  }
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  EXPECT_EQ(bench.motor.feedback().jumps, 0U);
}

TEST(RobStrideMotor, BeyondTheScaleOperationModeOnlyDamps) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(12.5);
  bench.now += milliseconds{2};
  bench.run(-12.5);  // two turns and a little more
  const auto told = bench.operation({.mode = ControlMode::kTotalAngle, .value = 0.0});
  EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
  EXPECT_GT(told.damping_nms_per_rad, 0.0);
  EXPECT_NE(bench.motor.limits() & kLimitAngle, 0U);
}

TEST(RobStrideMotor, TheEndOfAScaleThatDoesNotWrapLosesTheReference) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run(12.4);
  ASSERT_TRUE(bench.motor.setZero(0.0));
  bench.now += milliseconds{2};
  bench.run(13.0);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(RobStrideMotor, ALongSilenceLosesTheReferenceOfACyberGear) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run(0.3);
  ASSERT_TRUE(bench.motor.setZero(0.0));
  bench.now += milliseconds{150};
  bench.run(0.3);
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  bench.now += milliseconds{250};
  bench.run(0.3);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(RobStrideMotor, AJumpIsCountedAndAnglesAreNotFollowedUntilEnabledAnew) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(0.0);
  bench.now += milliseconds{1};
  bench.run(2.0);
  EXPECT_EQ(bench.motor.feedback().jumps, 1U);
  EXPECT_EQ(bench.operation({.mode = ControlMode::kTotalAngle, .value = 0.0}).stiffness_nm_per_rad, 0.0);
  bench.tick(FrameKind::kEnable);
  EXPECT_GT(bench.operation({.mode = ControlMode::kTotalAngle, .value = 0.0}).stiffness_nm_per_rad, 0.0);
}

TEST(RobStrideMotor, GearAndDirectionApplyToAllReadings) {
  auto settings = robStrideSettings("RS02");
  settings.gear_ratio = 7.75 * 3;
  settings.direction = -1;
  Bench bench(settings);
  bench.say({.position_rad = 0.0, .velocity_rad_s = 3.0, .torque_nm = 1.5, .mode = robstride::kRunning});
  const double before_deg = bench.motor.feedback().total_angle_deg;
  EXPECT_NEAR(bench.motor.feedback().velocity_rpm, -kRpmPerRadPerS, 0.01);
  EXPECT_NEAR(bench.motor.feedback().torque_nm, -4.5, 2e-3);
  EXPECT_NEAR(bench.motor.feedback().current_a, -1.5 / (1.22 / std::numbers::sqrt2), 1e-3);
  bench.now += milliseconds{20};
  bench.run(0.3);
  EXPECT_NEAR(bench.motor.feedback().total_angle_deg - before_deg, -0.1 * kDegPerRad, 0.02);
  EXPECT_FALSE(bench.motor.feedback().zeroed);  // behind a gear of its own the encoder is not absolute
}

TEST(RobStrideMotor, TheSupplyVoltageIsRead) {
  Bench bench(robStrideSettings("RS00"));
  EXPECT_EQ(bench.parameter(robstride::parameter::kSupplyVoltage, std::bit_cast<std::uint32_t>(47.5F), false),
            FrameVerdict::kAccepted);
  EXPECT_TRUE(std::isnan(bench.motor.feedback().voltage_v));
  bench.parameter(robstride::parameter::kSupplyVoltage, std::bit_cast<std::uint32_t>(47.5F));
  EXPECT_FLOAT_EQ(bench.motor.feedback().voltage_v, 47.5F);
  for (const float odd : {-1.0F, 1e9F, std::numeric_limits<float>::quiet_NaN()}) {
    bench.parameter(robstride::parameter::kSupplyVoltage, std::bit_cast<std::uint32_t>(odd));
    EXPECT_FLOAT_EQ(bench.motor.feedback().voltage_v, 47.5F);
  }
}

TEST(RobStrideMotor, ReportsOfType24AreFeedbackToo) {
  Bench bench(robStrideSettings("RS00"));
  auto frame = bench.codec.answer({.position_rad = 1.0, .mode = robstride::kRunning});
  frame.id.value = (frame.id.value & 0x00FFFFFFU) | 24U << 24U;
  ASSERT_TRUE(bench.motor.matchesFrame(frame));
  EXPECT_EQ(bench.motor.updateFeedback(frame), FrameVerdict::kAccepted);
  EXPECT_NEAR(bench.motor.feedback().total_angle_deg, kDegPerRad, 0.05);
}

TEST(RobStrideMotor, FramesOfOthersAndOddFramesAreNotTaken) {
  Bench bench(robStrideSettings("RS00"));
  const auto good = bench.codec.answer({.mode = robstride::kRunning});
  ASSERT_TRUE(bench.motor.matchesFrame(good));
  auto other = good;
  other.id.value = 0x0280'10FD;  // another drive
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.id.value = 0x0280'7FFE;  // for another host
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.id.extended = false;
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.fd = true;
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.id.value = 0x0300'FD7F;  // a host's command
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.length = 7;
  EXPECT_EQ(bench.motor.updateFeedback(other), FrameVerdict::kMalformed);
  other = good;
  other.type = FrameType::kRemote;
  EXPECT_EQ(bench.motor.updateFeedback(other), FrameVerdict::kMalformed);
  EXPECT_EQ(bench.motor.feedback().samples, 0U);
}

TEST(RobStrideMotor, GarbageLeavesFiniteReadings) {
  Bench bench(robStrideSettings("RS06"));
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    CanFrame frame = bench.codec.answer({});
    frame.id.value = (frame.id.value & 0x0000FFFFU) | static_cast<std::uint32_t>(random()) << 16U;
    frame.id.value &= kExtendedIdMask;
    for (std::size_t b = 0; b < 8; ++b) frame.data[b] = static_cast<std::uint8_t>(random());
    frame.received = bench.now += std::chrono::microseconds{random() % 2000};
    if (!bench.motor.matchesFrame(frame)) continue;
    (void)bench.motor.updateFeedback(frame);
    if (bench.motor.feedback().samples == 0) continue;
    ASSERT_TRUE(std::isfinite(bench.motor.feedback().total_angle_deg));
    ASSERT_TRUE(std::isfinite(bench.motor.feedback().current_a));
    ASSERT_LT(bench.motor.feedback().angle_deg, 360.0F);
  }
}

// --- Faults

TEST(RobStrideMotor, EveryFaultBitHasItsCode) {
  using enum FaultCode;
  const auto code = [](std::uint32_t native) { return robstride::faultOf(native, false); };
  EXPECT_EQ(code(0), kNone);
  EXPECT_EQ(code(1U << 0U), kDriveMotorTooHot);
  EXPECT_EQ(code(1U << 1U), kDriveHardware);
  EXPECT_EQ(code(1U << 2U), kDriveUnderVoltage);
  EXPECT_EQ(code(1U << 3U), kDriveOverVoltage);
  for (const unsigned phase : {4U, 5U, 16U}) EXPECT_EQ(code(1U << phase), kDriveOverCurrent);
  EXPECT_EQ(code(1U << 7U), kDriveCalibration);
  EXPECT_EQ(code(1U << 8U), kDriveHardware);
  EXPECT_EQ(code(1U << 9U), kDriveEncoder);
  EXPECT_EQ(code(1U << 14U), kDriveOverload);
  EXPECT_EQ(code(1U << 20U), kDriveOther);
  EXPECT_EQ(code(1U << 24U), kDriveUnderVoltage);
  EXPECT_EQ(code(1U << 25U), kDriveOverCurrent);
  EXPECT_EQ(code(1U << 26U), kDriveMotorTooHot);
  EXPECT_EQ(code(1U << 27U), kDriveEncoder);
  EXPECT_EQ(code(1U << 28U), kDriveOverload);
  EXPECT_EQ(code(1U << 29U), kDriveCalibration);
  EXPECT_EQ(robstride::faultOf(1U << 28U, true), kDrivePhase);
  EXPECT_EQ(robstride::faultOf(1U << 9U, true), kDriveOverload);
}

TEST(RobStrideMotor, AFaultFrameIsAComplaintUntilItIsClearedWhicheverWayRoundItsIdsAre) {
  for (const std::uint32_t id : {0x15007FFDU, 0x1500FD7FU}) {
    Bench bench(robStrideSettings("CyberGear"));
    bench.say({.mode = 0});
    const CanFrame fault = makeClassicFrame({id, true}, std::array<std::uint8_t, 8>{0x08});
    ASSERT_TRUE(bench.motor.matchesFrame(fault));
    ASSERT_EQ(bench.motor.updateFeedback(fault), FrameVerdict::kAccepted);
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveOverVoltage);
    EXPECT_EQ(bench.motor.complaint().native_code, 8U);
    bench.say({.mode = 0});
    bench.tick(FrameKind::kPoll);
    EXPECT_NE(bench.motor.complaint().fault, FaultCode::kNone);
    bench.motor.clearComplaint();
    const auto frames = bench.tick(FrameKind::kPoll);
    EXPECT_EQ(typeOf(frames[0]), 4U);
    EXPECT_EQ(frames[0].data[0], 1);
    EXPECT_EQ(bench.tick(FrameKind::kPoll)[0].data[0], 0);  // once
    bench.say({.mode = 0});
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
  }
}

TEST(RobStrideMotor, ADriveThatLeavesItsRunModeComplainsAndItsAnglesAreInDoubt) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run();
  bench.motor.setZero(0.0);
  bench.tick(FrameKind::kIdle);
  bench.run();
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
  bench.say({.mode = 0});
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
  bench.tick(FrameKind::kPoll);  // told to stop: nothing wrong with being stopped
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
}

// --- Enabling

TEST(RobStrideMotor, EnablingSetsAndReadsBackAndThenHasNoTorque) {
  Bench bench(robStrideSettings("RS00"));
  auto frames = bench.tick(FrameKind::kEnable);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(typeOf(frames[0]), 4U);
  EXPECT_TRUE(bench.tick().empty());  // waits for the answer
  bench.say({.position_rad = 0.4, .mode = 0});

  const std::array<std::uint16_t, 3> settings{robstride::parameter::kRunMode,
                                              robstride::parameter::kTorqueLimit, 0x7028};
  for (const auto index : settings) {
    frames = bench.tick();
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(typeOf(frames[0]), 18U);
    EXPECT_EQ(typeOf(frames[1]), 17U);
    EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), index);
    bench.say({.position_rad = 0.4, .mode = 0});
    bench.parameter(index, readLittleEndian<std::uint32_t>(frames[0].payload(), 4));
  }
  frames = bench.tick();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kPosition);
  bench.parameter(robstride::parameter::kPosition, std::bit_cast<std::uint32_t>(0.4F));

  frames = bench.tick();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(typeOf(frames[1]), 3U);
  for (const std::size_t around : {0U, 2U}) {
    EXPECT_EQ(bench.codec.operation(frames[around]).stiffness_nm_per_rad, 0.0);
    EXPECT_NEAR(bench.codec.operation(frames[around]).torque_nm, 0.0, 1e-3);
  }
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
  bench.run(0.4);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kDone);
  frames = bench.tick();
  EXPECT_EQ(bench.codec.operation(frames.at(0)).stiffness_nm_per_rad, 0.0);
}

TEST(RobStrideMotor, AnUnansweredStepIsSentFiveTimesAndThenFails) {
  Bench bench(robStrideSettings("RS00"));
  int sent = 0;
  for (int i = 0; i < 251; ++i) sent += static_cast<int>(bench.tick(FrameKind::kEnable).size());
  EXPECT_EQ(sent, 5);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kFailed);
  bench.tick(FrameKind::kPoll);
  EXPECT_EQ(bench.tick(FrameKind::kEnable).size(), 1U);  // anew
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
}

TEST(RobStrideMotor, ASettingThatTheDriveDoesNotKeepFailsTheEnabling) {
  Bench bench(robStrideSettings("RS00"));
  bench.tick(FrameKind::kEnable);
  bench.say({.mode = 0});
  int asked = 0;
  for (int i = 0; i < 400; ++i) {
    for (const auto& frame : bench.tick()) {
      EXPECT_NE(typeOf(frame), 3U);
      if (typeOf(frame) == 17) bench.parameter(robstride::parameter::kRunMode, 2);
      asked += typeOf(frame) == 17 ? 1 : 0;
    }
  }
  EXPECT_GT(asked, 0);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kFailed);
}

TEST(RobStrideMotor, ALimitMayBecomeSmallerButNotLarger) {
  const auto limit = RobstrideSetting::limit(robstride::parameter::kCurrentLimit, 23.0F);
  EXPECT_TRUE(limit.agrees(std::bit_cast<std::uint32_t>(16.0F)));
  EXPECT_TRUE(limit.agrees(std::bit_cast<std::uint32_t>(23.0F)));
  EXPECT_FALSE(limit.agrees(std::bit_cast<std::uint32_t>(30.0F)));
  EXPECT_FALSE(limit.agrees(std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN())));
}

TEST(RobStrideMotor, NoFrameEverSavesOrChangesASettingForGood) {
  for (const std::string control : {"operation", "current", "velocity", "position"}) {
    Bench bench(controlled(control));
    for (const auto kind : {FrameKind::kPoll, FrameKind::kEnable, FrameKind::kIdle, FrameKind::kCommand,
                            FrameKind::kBrake, FrameKind::kRest, FrameKind::kDisable}) {
      int told = 0;
      for (int i = 0; i < 60; ++i) {
        bench.run();
        for (const auto& frame : bench.tick(kind)) {
          const auto type = typeOf(frame);
          EXPECT_TRUE(type == 1 || type == 3 || type == 4 || type == 17 || type == 18) << type;
          ++told;
        }
      }
      EXPECT_GT(told, 0) << control;
    }
  }
}

// --- The family

TEST(RobstrideFamily, TraitsAgreeWithTheFrames) {
  const auto& family = robstrideFamily();
  EXPECT_EQ(family.models().size(), 9U);
  for (const auto model : family.models()) {
    for (const std::string control : {"operation", "current", "velocity", "position"}) {
      const auto settings = controlled(control, model);
      const auto traits = family.traits(model, settings.own);
      EXPECT_TRUE(traits.asked);
      EXPECT_TRUE(traits.watchdog);
      EXPECT_EQ(traits.modes.contains(ControlMode::kImpedance), control == "operation");
      EXPECT_EQ(traits.modes.contains(ControlMode::kCurrent), control == "operation" || control == "current");
      EXPECT_EQ(traits.absolute, model != "CyberGear");
      EXPECT_TRUE(family.check(settings).has_value());
      EXPECT_FALSE(family.busUse(settings).commands.empty());
    }
  }
}

TEST(RobstrideFamily, RefusesWhatCannotWorkAndNamesTheKey) {
  const auto begins = [](const MotorSettings& settings) {
    const auto checked = robstrideFamily().check(settings);
    return checked ? std::string{} : checked.error().message.substr(0, checked.error().message.find(':'));
  };
  auto settings = robStrideSettings("RS00", 100);
  EXPECT_EQ(begins(settings), "");
  settings.own.set("host_id", 100.0);
  EXPECT_EQ(begins(settings), "host_id");
  settings = robStrideSettings("RS00");
  settings.own.set("position_range_rad", 6.0);
  EXPECT_EQ(begins(settings), "position_range_rad");
  settings = robStrideSettings("RS00");
  settings.own.set("watchdog_ms", 30.0);
  settings.command_divider = 10;
  EXPECT_EQ(begins(settings), "watchdog_ms");
  settings.own.set("watchdog_ms", 0.0);
  EXPECT_EQ(begins(settings), "");
}

TEST(RobstrideFamily, DrivesShareABusUnlessTheyShareAnId) {
  SocketPair wire;
  const auto bus = fdCANbus::adopt("bus", std::move(wire.near), false);
  BusParts parts(*bus);
  std::vector<std::unique_ptr<Motor_Base>> motors;
  for (int id = 1; id <= 6; ++id) {
    auto settings = robStrideSettings(id % 2 == 0 ? "RS00" : "CyberGear", id);
    settings.name = "joint" + std::to_string(id);
    auto built = robstrideFamily().build(settings, parts);
    ASSERT_TRUE(built.has_value()) << built.error().message;
    motors.push_back(std::move(*built));
  }
  auto again = robStrideSettings("RS02", 3);
  again.name = "other";
  const auto refused = robstrideFamily().build(again, parts);
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("joint3"), std::string::npos);
  const robstride::Codec codec{
      .model = findRobstrideModel("RS00"), .position_range_rad = 12.57, .drive_id = 4, .host_id = kHost};
  bus->dispatch(codec.answer({.position_rad = 1.0}));
  for (std::size_t i = 0; i < motors.size(); ++i) {
    EXPECT_EQ(motors[i]->feedback().samples, i == 3 ? 1U : 0U);
  }
}

TEST(RobStrideMotor, NothingAllocatesAfterConstruction) {
  Bench bench(robStrideSettings("RS00"));
  const auto answer = bench.codec.answer({.mode = robstride::kRunning});
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  AllocGuard guard;
  for (int i = 0; i < 500; ++i) {
    const Tick tick{.index = static_cast<std::uint64_t>(i), .now = bench.now += milliseconds{1}};
    bench.motor.order(static_cast<FrameKind>(i % 9), {.mode = ControlMode::kTotalAngle, .value = 10.0});
    (void)bench.motor.updateFeedback(answer);
    bench.motor.update(tick);
    (void)bench.motor.packCommand(tick, out);
    (void)bench.motor.complaint();
  }
  EXPECT_EQ(guard.allocations(), 0U);
}

}  // namespace
}  // namespace rc10::test::robstride_motor_test
