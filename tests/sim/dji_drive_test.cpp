#include "drives/dji/dji_simulated.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drives/dji/dji_motor.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test::dji_drive_test {
namespace {

using namespace std::chrono_literals;
using sim::DjiDrive;
using sim::DjiDriveConfig;

using Bytes = std::array<std::uint8_t, 8>;

CanFrame frame(std::uint32_t id, const Bytes& data) { return makeClassicFrame({id, false}, data); }

DjiDriveConfig config(const DjiModel& model, int id, DjiCommand command = DjiCommand::kCurrent) {
  return {.name = "motor", .model = &model, .id = id, .command = command, .gear_ratio = 0.0, .load = {}};
}

Bytes payload(const CanFrame& frame) {
  Bytes bytes{};
  std::copy_n(frame.data.begin(), bytes.size(), bytes.begin());
  return bytes;
}

/// The current of a stalled motor a while after the command.
double currentAfter(DjiDriveConfig config, const CanFrame& command) {
  config.load.stalled = true;
  DjiDrive drive{config};
  drive.receive(command);
  drive.step(20ms);
  return drive.physics().currentA();
}

DJI_Motor decoder(const DjiDriveConfig& config) {
  MotorSettings motor;
  motor.name = config.name;
  motor.model = config.model->name;
  motor.id = config.id;
  motor.own = djiOwn(config.command);
  motor.gear_ratio = config.gear_ratio;
  motor.loops = config.model->command(config.command).default_loops;
  return DJI_Motor{motor};
}

// Vectors computed by hand from the manuals of C620 V1.01, C610 and GM6020 v1.2.
TEST(DjiDrive, DecodesTheC620CommandVector) {
  const auto command = frame(0x200, {0x20, 0x00, 0xF0, 0x00, 0x00, 0x00, 0x40, 0x00});
  EXPECT_NEAR(currentAfter(config(kM3508, 1), command), 10.0, 1e-3);
  EXPECT_NEAR(currentAfter(config(kM3508, 2), command), -5.0, 1e-3);
  EXPECT_NEAR(currentAfter(config(kM3508, 3), command), 0.0, 1e-9);
  EXPECT_NEAR(currentAfter(config(kM3508, 4), command), 20.0, 1e-3);
}

TEST(DjiDrive, DecodesTheC610CommandVector) {
  const auto command = frame(0x1FF, {0x09, 0xC4, 0xD8, 0xF0, 0x00, 0x00, 0x00, 0x00});
  EXPECT_NEAR(currentAfter(config(kM2006, 5), command), 2.5, 1e-3);
  EXPECT_NEAR(currentAfter(config(kM2006, 6), command), -10.0, 1e-3);
}

TEST(DjiDrive, DecodesTheGM6020VoltageVector) {
  const auto command = frame(0x1FF, {0x30, 0xD4, 0x9E, 0x58, 0x00, 0x00, 0x00, 0x00});
  const auto one = config(kGM6020, 1, DjiCommand::kVoltage);
  const double resistance_ohm = DjiDrive{one}.physics().parameters().resistance_ohm;
  EXPECT_NEAR(currentAfter(one, command) * resistance_ohm, 12.0, 1e-3);
  EXPECT_NEAR(currentAfter(config(kGM6020, 2, DjiCommand::kVoltage), command) * resistance_ohm, -24.0, 1e-3);
}

TEST(DjiDrive, DecodesTheGM6020CurrentVector) {
  const auto command = frame(0x2FE, {0x15, 0x55, 0x00, 0x00, 0xC0, 0x00, 0x00, 0x00});
  EXPECT_NEAR(currentAfter(config(kGM6020, 5), command), 0.9999, 1e-3);
  EXPECT_NEAR(currentAfter(config(kGM6020, 6), command), 0.0, 1e-9);
  EXPECT_NEAR(currentAfter(config(kGM6020, 7), command), -3.0, 1e-3);
}

TEST(DjiDrive, IgnoresFramesThatAreNotItsCommand) {
  const Bytes full{0x40, 0x00, 0x40, 0x00, 0x40, 0x00, 0x40, 0x00};
  CanFrame shorter = frame(0x200, full);
  shorter.length = 6;
  CanFrame remote = frame(0x200, full);
  remote.type = FrameType::kRemote;
  for (const CanFrame& other : {frame(0x1FF, full), frame(0x201, full), makeClassicFrame({0x200, true}, full),
                                makeFdFrame({0x200, false}, full, true), shorter, remote}) {
    DjiDrive drive{config(kM3508, 1)};
    drive.receive(other);
    EXPECT_EQ(drive.rawCommand(), 0);
    drive.receive(frame(0x200, full));
    EXPECT_EQ(drive.rawCommand(), 0x4000) << "its own it takes";
  }
}

TEST(DjiDrive, ObeysOnlyTheCommandItIsSetTo) {
  const Bytes full{0x10, 0x00, 0, 0, 0, 0, 0, 0};
  DjiDrive voltage{config(kGM6020, 1, DjiCommand::kVoltage)};
  DjiDrive current{config(kGM6020, 1, DjiCommand::kCurrent)};
  for (DjiDrive* drive : {&voltage, &current}) drive->receive(frame(0x1FE, full));
  EXPECT_EQ(voltage.rawCommand(), 0);
  EXPECT_EQ(current.rawCommand(), 0x1000);
}

TEST(DjiDrive, KeepsTheLastCommandWhenCommandsStop) {
  DjiDrive drive{config(kM3508, 1)};
  drive.receive(frame(0x200, {0x08, 0x00, 0, 0, 0, 0, 0, 0}));
  drive.step(10s);
  EXPECT_GT(drive.physics().outputRpm(), 400.0);
  EXPECT_EQ(drive.rawCommand(), 0x0800);
}

TEST(DjiDrive, ReportsPositionAndTemperatureInTheDrivesFormat) {
  DjiDriveConfig c620 = config(kM3508, 3);
  c620.gear_ratio = 1.0;
  c620.load.initial_angle_deg = 180.01F;
  DjiDrive drive{c620};
  drive.physics().setTemperature(45.2);
  const CanFrame feedback = drive.feedbackFrame();
  EXPECT_EQ(feedback.id, (CanId{0x203, false}));
  EXPECT_EQ(feedback.length, 8);
  EXPECT_FALSE(feedback.fd);
  EXPECT_EQ(payload(feedback), (Bytes{0x10, 0x00, 0, 0, 0, 0, 0x2D, 0}));
}

TEST(DjiDrive, ReportsCurrentInTheDrivesScale) {
  DjiDriveConfig stalled = config(kGM6020, 7);
  stalled.load.stalled = true;
  DjiDrive drive{stalled};
  drive.receive(frame(0x2FE, {0, 0, 0, 0, 0x10, 0x00, 0, 0}));  // 4096 = 0.75 A
  drive.step(20ms);
  EXPECT_EQ(drive.feedbackFrame().id, (CanId{0x20B, false}));
  EXPECT_EQ(payload(drive.feedbackFrame()), (Bytes{0, 0, 0, 0, 0x10, 0x00, 25, 0}));
}

TEST(DjiDrive, C610LeavesTheTemperatureByteEmpty) {
  DjiDrive drive{config(kM2006, 1)};
  drive.physics().setTemperature(80.0);
  EXPECT_EQ(drive.feedbackFrame().data[6], 0);
  DjiDrive other{config(kM3508, 1)};
  other.physics().setTemperature(80.0);
  EXPECT_EQ(other.feedbackFrame().data[6], 80);
}

TEST(DjiDrive, TemperatureByteStaysInRange) {
  DjiDrive drive{config(kM3508, 1)};
  drive.physics().setTemperature(-10.0);
  EXPECT_EQ(drive.feedbackFrame().data[6], 0);
  drive.physics().setTemperature(400.0);
  EXPECT_EQ(drive.feedbackFrame().data[6], 255);
}

TEST(DjiDrive, ReportedSpeedIsAMillisecondBehindTheRotor) {
  DjiDriveConfig heavy = config(kM3508, 1);
  heavy.load = {.inertia_kg_m2 = 0.1F, .viscous_nms_per_rad = 0.0F, .coulomb_nm = 0.0F};
  DjiDrive drive{heavy};
  drive.receive(frame(0x200, {0x20, 0x00, 0, 0, 0, 0, 0, 0}));
  drive.step(200ms);
  const double before_rpm = drive.physics().rotorRpm();
  drive.step(1ms);
  EXPECT_GT(drive.physics().rotorRpm(), before_rpm);
  EXPECT_NEAR(drive.physics().measuredRotorRpm(), before_rpm, 0.1);
}

struct Ride {
  std::string_view name;
  const DjiModel* model;
  DjiCommand command;
};

class EveryDrive : public testing::TestWithParam<Ride> {};

INSTANTIATE_TEST_SUITE_P(Dji, EveryDrive,
                         testing::Values(Ride{"M3508", &kM3508, DjiCommand::kCurrent},
                                         Ride{"M2006", &kM2006, DjiCommand::kCurrent},
                                         Ride{"GM6020Current", &kGM6020, DjiCommand::kCurrent},
                                         Ride{"GM6020Voltage", &kGM6020, DjiCommand::kVoltage}),
                         [](const auto& param) { return std::string{param.param.name}; });

TEST_P(EveryDrive, FeedbackDecodesToWhatThePhysicsSaysForwardAndBack) {
  DjiDriveConfig ride = config(*GetParam().model, 2, GetParam().command);
  DjiDrive drive{ride};
  DJI_Motor motor = decoder(ride);
  const double count_deg = 360.0 / 8192.0 / ride.model->gear_ratio;
  const auto& limits = ride.model->encoder;
  MonotonicTime now{100s};
  std::int64_t most_turns = 0;
  CanFrame command = frame(drive.commandId().value, {});
  for (int i = 0; i < 4000; ++i, now += 1ms) {
    // Full ahead, full astern, coast.
    const int raw = i < 1500 ? 8000 : i < 3000 ? -9000 : 0;
    command.data[2] = static_cast<std::uint8_t>(static_cast<unsigned>(raw) >> 8U);
    command.data[3] = static_cast<std::uint8_t>(raw & 0xFF);
    CanFrame feedback = drive.feedbackFrame();
    feedback.received = now;
    ASSERT_TRUE(motor.matchesFrame(feedback));
    ASSERT_EQ(motor.updateFeedback(feedback), FrameVerdict::kAccepted);
    const auto& seen = motor.feedback();
    const auto& truth = drive.physics();
    ASSERT_NEAR(seen.total_angle_deg, truth.outputAngleDeg(), 1.01 * count_deg) << "at " << i << " ms";
    ASSERT_NEAR(static_cast<double>(seen.velocity_rpm), truth.outputRpm(),
                static_cast<double>(limits.velocity_error_rpm) / ride.model->gear_ratio);
    ASSERT_NEAR(static_cast<double>(seen.current_a), truth.currentA(), 0.001);
    ASSERT_NEAR(static_cast<double>(seen.torque_nm), truth.outputTorqueNm(), 0.001);
    most_turns = std::max(most_turns, std::abs(truth.rotorTurns()));
    drive.receive(command);
    drive.step(1ms);
  }
  EXPECT_GE(most_turns, 2);
}

TEST(DjiDrive, CheckRefusesWhatDoesNotExist) {
  const auto refusal = [](const DjiDriveConfig& config) {
    const auto checked = DjiDrive::check(config);
    return checked ? std::string{} : checked.error().message;
  };
  EXPECT_EQ(refusal(config(kM3508, 8)), "");
  EXPECT_NE(refusal(config(kM3508, 9)).find("id 9 does not exist on a M3508: use 1 to 8"), std::string::npos);
  EXPECT_NE(refusal(config(kGM6020, 8)).find("use 1 to 7"), std::string::npos);
  EXPECT_NE(refusal(config(kM2006, 1, DjiCommand::kVoltage)).find("no voltage command"), std::string::npos);
  EXPECT_NE(refusal(DjiDriveConfig{}).find("no model"), std::string::npos);
  DjiDriveConfig lossy = config(kM3508, 1);
  lossy.load.lost_frames = 1.5F;
  EXPECT_NE(refusal(lossy).find("lost_frames"), std::string::npos);
  DjiDriveConfig weightless = config(kM3508, 1);
  weightless.load.inertia_kg_m2 = -1.0F;
  EXPECT_NE(refusal(weightless).find("inertia_kg_m2"), std::string::npos);
}

}  // namespace
}  // namespace rc10::test::dji_drive_test
