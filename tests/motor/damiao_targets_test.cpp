#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "motor/damiao_desk.hpp"

namespace rc10::test::damiao_targets_test {
namespace {

using namespace damiao_desk;

// --- Targets ---

TEST(DamiaoMotor, TorqueIsWhatTheCurrentMakesAndSaturatesAtTheLimit) {
  auto settings = damiaoSettingsOf();
  settings.effort_limit = 4.0F;
  EnabledDesk desk(settings);
  desk.command({.mode = ControlMode::kCurrent, .value = 2.0, .torque_ff_nm = 0.5F});
  EXPECT_NEAR(mitOf(desk.tick()).torque_nm, 2.0 * 0.945 + 0.5, 0.006);
  EXPECT_EQ(desk.motor().limits(), 0U);
  for (const double a : {100.0, -100.0, 1e300, -kInfinity, kInfinity}) {
    desk.command({.mode = ControlMode::kCurrent, .value = a});
    const double torque_nm = mitOf(desk.tick()).torque_nm;
    if (std::isinf(a)) {
      EXPECT_NEAR(torque_nm, 0.0, 0.003);
    } else {
      EXPECT_NEAR(torque_nm, std::copysign(4.0 * 0.945, a), 0.006);
      EXPECT_EQ(desk.motor().limits(), std::uint32_t{kLimitCurrent});
    }
  }
  desk.motor().derate(0.25F);
  desk.command({.mode = ControlMode::kCurrent, .value = 100.0});
  EXPECT_NEAR(mitOf(desk.tick()).torque_nm, 0.945, 0.006);
}

TEST(DamiaoMotor, ImpedanceIsSentAsTold) {
  EnabledDesk desk;
  desk.command({.mode = ControlMode::kImpedance,
                .value = 20.0,
                .velocity_ff_rpm = 10.0F,
                .torque_ff_nm = 0.3F,
                .stiffness_nm_per_rad = 12.0F,
                .damping_nms_per_rad = 0.7F});
  const auto command = mitOf(desk.tick());
  EXPECT_NEAR(command.position_rad, 20.0 / 57.29578, 0.001);
  EXPECT_NEAR(command.velocity_rad_s, 10.0 * 0.1047198, 0.02);
  EXPECT_NEAR(command.stiffness_nm_per_rad, 12.0, 0.13);
  EXPECT_NEAR(command.damping_nms_per_rad, 0.7, 0.002);
  EXPECT_NEAR(command.torque_nm, 0.3, 0.006);
}

TEST(DamiaoMotor, BeyondItsRangeImpedanceOnlyDamps) {
  EnabledDesk desk;
  for (double rad = 0.0; rad < 14.0; rad += 0.1) (void)desk.feed(stateAt(std::remainder(rad, 25.0), 0.0));
  desk.command({.mode = ControlMode::kImpedance,
                .value = 2000.0,
                .velocity_ff_rpm = 60.0F,
                .torque_ff_nm = 2.0F,
                .stiffness_nm_per_rad = 10.0F});
  const auto command = mitOf(desk.tick());
  EXPECT_EQ(command.stiffness_nm_per_rad, 0.0);
  EXPECT_GT(command.damping_nms_per_rad, 0.1);
  EXPECT_NEAR(command.velocity_rad_s, 0.0, 0.01);
  EXPECT_NEAR(command.torque_nm, 0.0, 0.003);
  EXPECT_NE(desk.motor().limits() & kLimitAngle, 0U);
}

TEST(DamiaoMotor, AGearBehindTheDriveCountsOnceForAnglesAndSquaredForGains) {
  auto settings = damiaoSettingsOf();
  settings.gear_ratio = 20.0;  // 2 behind the drive's own 10
  settings.direction = -1;
  settings.zero_at_power_on = true;
  EnabledDesk desk(settings);
  desk.command({.mode = ControlMode::kImpedance,
                .value = 10.0,
                .torque_ff_nm = 1.0F,
                .stiffness_nm_per_rad = 40.0F,
                .damping_nms_per_rad = 2.0F});
  const auto command = mitOf(desk.tick());
  EXPECT_NEAR(command.position_rad, -20.0 / 57.29578, 0.001);
  EXPECT_NEAR(command.stiffness_nm_per_rad, 10.0, 0.13);
  EXPECT_NEAR(command.damping_nms_per_rad, 0.5, 0.002);
  EXPECT_NEAR(command.torque_nm, -0.5, 0.006);
  (void)desk.feed(stateAt(0.0, 4.0));
  EXPECT_NEAR(static_cast<double>(desk.motor().feedback().velocity_rpm), -2.0 * 9.549, 0.1);
}

TEST(DamiaoMotor, BrakeDampAndHoldAreAllWithinTheTorqueLimit) {
  auto settings = damiaoSettingsOf();
  settings.effort_limit = 0.5F;
  EnabledDesk desk(settings);
  for (const auto kind : {FrameKind::kBrake, FrameKind::kDamp, FrameKind::kHold, FrameKind::kIdle}) {
    desk.motor().order(kind);
    (void)desk.tick();
    for (const double rad_s : {25.0, -25.0}) {
      for (const double share : {0.0, 1.0}) (void)desk.feed(stateAt(0.0, share * rad_s));
      const auto command = mitOf(desk.tick());
      const double at_rad = damiao::fromCode(damiao::toCode(0.0, 12.5, 16), 12.5, 16);
      const double nm = command.stiffness_nm_per_rad * (command.position_rad - at_rad) +
                        command.damping_nms_per_rad * (command.velocity_rad_s - rad_s) + command.torque_nm;
      EXPECT_LE(std::fabs(nm), 0.5 * 0.945 + 0.05);
      if (kind != FrameKind::kIdle) {
        EXPECT_LT(nm * rad_s, 0.0) << "against the motion";
      }
    }
  }
}

/// Torque by the motor's last feedback never exceeds the limit, whatever is wanted; every field decodes.
TEST(DamiaoMotor, NoMitTargetWhateverItIsAsksForMoreThanTheLimit) {
  std::mt19937 generator(42);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const auto odd = [&generator, &share]() {
    switch (generator() % 8) {
      case 0: return kNan;
      case 1: return kInfinity;
      case 2: return -kInfinity;
      case 3: return 1e300 * share(generator);
      case 4: return 1e5 * share(generator);
      default: return 100.0 * share(generator);
    }
  };
  const std::array kModes{ControlMode::kCurrent,    ControlMode::kVelocity,  ControlMode::kAngle,
                          ControlMode::kTotalAngle, ControlMode::kImpedance, ControlMode::kBrake,
                          ControlMode::kDuty,       ControlMode::kCoast};
  for (const float limit_a : {0.8F, 3.0F, 0.0F}) {
    auto settings = damiaoSettingsOf();
    settings.effort_limit = limit_a;
    settings.velocity_limit_rpm = limit_a > 2.0F ? 50.0F : 0.0F;
    EnabledDesk desk(settings);
    const double limit_nm = 0.945 * static_cast<double>(limit_a > 0.0F ? limit_a : 10.261194F);
    double rad = 0.0;
    double rad_s = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      rad_s = std::clamp(rad_s + 8.0 * share(generator) - 0.5 * rad, -29.0, 29.0);
      rad += 0.001 * rad_s;
      (void)desk.feed(stateAt(rad, rad_s));
      const double at_rad = damiao::fromCode(desk.state.position, 12.5, 16);
      const double at_rad_s = damiao::fromCode(desk.state.velocity, 30.0, 12);
      desk.command({.mode = kModes[generator() % kModes.size()],
                    .value = odd(),
                    .velocity_ff_rpm = static_cast<float>(odd()),
                    .torque_ff_nm = static_cast<float>(odd()),
                    .stiffness_nm_per_rad = static_cast<float>(odd()),
                    .damping_nms_per_rad = static_cast<float>(odd())});
      const auto c = mitOf(desk.tick());
      const double nm = c.stiffness_nm_per_rad * (c.position_rad - at_rad) +
                        c.damping_nms_per_rad * (c.velocity_rad_s - at_rad_s) + c.torque_nm;
      // A step of the position at full stiffness is 0.19 Nm, one of the speed at full damping 0.07 Nm.
      ASSERT_LE(std::fabs(nm), limit_nm + 0.3);
      ASSERT_TRUE(std::isfinite(desk.motor().commandValue()));
      ASSERT_LE(std::fabs(static_cast<double>(desk.motor().commandValue())) * 0.945, limit_nm + 1e-3);
    }
  }
}

TEST(DamiaoMotor, AfterAPushAgainstWhatBlocksItAStopDoesNotPressOn) {
  auto settings = damiaoSettingsOf();
  settings.velocity_limit_rpm = 10.0F;
  EnabledDesk desk(settings);
  const auto torqueAt0Nm = [&](double place_deg) {
    desk.feed(stateAt(0.0));
    desk.command({.mode = ControlMode::kTotalAngle, .value = place_deg});
    return torqueNm(mitOf(desk.tick()), {});
  };
  for (int i = 0; i < 1500; ++i) (void)torqueAt0Nm(60.0);
  ASSERT_GT(torqueAt0Nm(60.0), 9.0);
  desk.motor().dropWindup(0.5F);
  EXPECT_LT(torqueAt0Nm(60.0), 1.3) << "damping times limit";
  EXPECT_LT(torqueAt0Nm(0.0), 0.2);
}

TEST(DamiaoMotor, NoSpeedOrPositionFrameExceedsTheLimits) {
  std::mt19937 generator(7);
  for (const std::string control : {"velocity", "position_velocity", "force_position"}) {
    auto settings = damiaoSettingsOf("DM4310", control);
    settings.velocity_limit_rpm = 100.0F;
    EnabledDesk desk(settings);
    const double limit_rad_s = 100.0 * 0.10471976;
    for (const double value : {0.0, 1e9, -1e9, 1e300, kInfinity, -kInfinity, kNan, 250.0, -250.0}) {
      desk.command({.mode = control == "velocity" ? ControlMode::kVelocity : ControlMode::kTotalAngle,
                    .value = value});
      const auto sent = desk.tick();
      ASSERT_EQ(sent.size(), 1U);
      const auto data = std::span(sent[0].data);
      const auto first = static_cast<double>(readLittleEndian<float>(data, 0));
      ASSERT_TRUE(std::isfinite(first));
      if (control == "velocity") {
        EXPECT_EQ(sent[0].length, 4);
        EXPECT_LE(std::fabs(first), limit_rad_s + 1e-3);
      } else if (control == "position_velocity") {
        const auto second = static_cast<double>(readLittleEndian<float>(data, 4));
        EXPECT_GE(second, 0.0);
        EXPECT_LE(second, limit_rad_s + 1e-3);
      } else {
        EXPECT_LE(readLittleEndian<std::uint16_t>(data, 4), 1048);
        EXPECT_LE(readLittleEndian<std::uint16_t>(data, 6), 10'000);
      }
    }
  }
}

TEST(DamiaoMotor, ForcePositionStandsWhereNoAngleCanBeFollowed) {
  DamiaoDesk desk(damiaoSettingsOf("DM4310", "force_position"));
  desk.xout_rad = 10'050.0F;
  ASSERT_TRUE(desk.enable());
  desk.motor().order(FrameKind::kHold);
  const auto sent = desk.tick();
  ASSERT_GE(sent.size(), 1U);
  EXPECT_EQ(readLittleEndian<std::uint16_t>(sent[0].data, 4), 0) << "speed";
  EXPECT_GT(readLittleEndian<std::uint16_t>(sent[0].data, 6), 1000) << "current";
  EXPECT_NE(desk.motor().limits() & kLimitAngle, 0U);
}

// Beyond its scale a torque is reported as one the other way.
TEST(DamiaoMotor, ForcePositionIsToldNoMoreTorqueThanTheFeedbackCanTell) {
  DamiaoDesk desk(damiaoSettingsOf("DM4340", "force_position"));
  ASSERT_TRUE(desk.enable());
  desk.motor().order(FrameKind::kHold);
  const auto sent = desk.tick();
  ASSERT_GE(sent.size(), 1U);
  EXPECT_EQ(readLittleEndian<std::uint16_t>(sent[0].data, 6), 6697) << "28 Nm of 4.074 Nm/A times 10.26 A";
}

TEST(DamiaoMotor, EveryCodeComesBackThroughItsValue) {
  for (std::uint32_t code = 0; code <= 0xFFFF; ++code) {
    ASSERT_EQ(damiao::toCode(damiao::fromCode(code, 12.5, 16), 12.5, 16), code);
  }
  for (std::uint32_t code = 0; code <= 0xFFF; ++code) {
    ASSERT_EQ(damiao::toCode(damiao::fromCode(code, 30.0, 12), 30.0, 12), code);
    ASSERT_EQ(damiao::toCode(damiao::fromCode(code, 10.0, 12), 10.0, 12), code);
  }
  EXPECT_EQ(damiao::toCode(1e300, 12.5, 16), 0xFFFF);
  EXPECT_EQ(damiao::toCode(-1e300, 12.5, 16), 0);
  EXPECT_EQ(damiao::toCode(kInfinity, 30.0, 12), 0xFFF);
  EXPECT_EQ(damiao::toCode(kNan, 30.0, 12), 0x7FF);
}

TEST(DamiaoMotor, EveryMitCommandComesBackWithinOneStep) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 100'000; ++i) {
    const SpringLaw sent{.position_rad = 25.0 * share(generator) - 12.5,
                         .velocity_rad_s = 60.0 * share(generator) - 30.0,
                         .stiffness_nm_per_rad = 500.0 * share(generator),
                         .damping_nms_per_rad = 5.0 * share(generator),
                         .torque_nm = 20.0 * share(generator) - 10.0};
    const auto back = damiao::readMit(damiao::mit(sent, kDm4310), kDm4310);
    ASSERT_NEAR(back.position_rad, sent.position_rad, 25.0 / 65535);
    ASSERT_NEAR(back.velocity_rad_s, sent.velocity_rad_s, 60.0 / 4095);
    ASSERT_NEAR(back.stiffness_nm_per_rad, sent.stiffness_nm_per_rad, 500.0 / 4095);
    ASSERT_NEAR(back.damping_nms_per_rad, sent.damping_nms_per_rad, 5.0 / 4095);
    ASSERT_NEAR(back.torque_nm, sent.torque_nm, 20.0 / 4095);
  }
}

TEST(DamiaoMotor, GarbageLeavesFiniteReadings) {
  std::mt19937 generator(11);
  DamiaoDesk desk(damiaoSettingsOf("DM4340", "mit", 15));
  for (int i = 0; i < 100'000; ++i) {
    damiao::Payload payload{};
    for (auto& byte : payload) byte = static_cast<std::uint8_t>(generator());
    payload[0] = static_cast<std::uint8_t>((payload[0] & 0xF0U) | 15U);
    (void)desk.give(payload);
    if (i % 3 == 0) (void)desk.tick();
    const auto& feedback = desk.motor().feedback();
    ASSERT_TRUE(std::isfinite(feedback.total_angle_deg));
    ASSERT_TRUE(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
    ASSERT_TRUE(std::isfinite(feedback.velocity_rpm) && std::isfinite(feedback.current_a));
    ASSERT_TRUE(feedback.temperature_c >= -56.0F && feedback.temperature_c <= 200.0F);
  }
}

}  // namespace
}  // namespace rc10::test::damiao_targets_test
