// Speed scale of every family whose drives report speed as a share of a range: its plausibility.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "drives/cubemars/cubemars_simulated.hpp"
#include "drives/damiao/damiao_simulated.hpp"
#include "drives/families.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/cubemars_settings.hpp"
#include "support/damiao_motors.hpp"
#include "support/robstride_settings.hpp"

namespace rc10::test::speed_scale_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr float kRpm = 40.0F;

/// Speed of a feedback frame as it would be on a range `ratio` times smaller.
void rescale(CanFrame& frame, std::size_t byte, unsigned bits, double ratio) {
  const unsigned unused = 16 - bits;
  const unsigned word = static_cast<unsigned>(frame.data[byte]) << 8U | frame.data[byte + 1];
  const double middle = 0.5 * static_cast<double>((1U << bits) - 1);
  const double code = middle + ratio * (static_cast<double>(word >> unused) - middle);
  const double within = std::clamp(code, 0.0, 2.0 * middle);
  const unsigned told = static_cast<unsigned>(std::lround(within)) << unused | (word & ((1U << unused) - 1));
  frame.data[byte] = static_cast<std::uint8_t>(told >> 8U);
  frame.data[byte + 1] = static_cast<std::uint8_t>(told & 0xFFU);
}

SoloRig damiao(const std::string& control, double error) {
  auto settings = damiaoSettingsOf("DM4310", control);
  settings.scale_error = error;
  return {std::make_unique<Damiao_Motor>(settings), sim::makeDamiaoDrive(settings, {})};
}

SoloRig damiaoMit(double error) { return damiao("mit", error); }
SoloRig damiaoVelocity(double error) { return damiao("velocity", error); }

SoloRig robstride(double error) {
  auto settings = robStrideSettings("RS00");
  settings.own.set("control", std::string{"velocity"});
  settings.scale_error = error;
  return {std::make_unique<RobStride_Motor>(settings), sim::makeRobstrideDrive(settings, {})};
}

SoloRig cubemars(double error) {
  auto settings = cubemarsSettings("AK80-9", 12, {{"protocol", std::string{"mit"}}});
  settings.zero_at_power_on = true;
  settings.scale_error = error;
  return {std::make_unique<CubemarsMit>(settings, setupOf(settings)), sim::makeCubemarsDrive(settings, {})};
}

SoloRig myactuator(double error) {
  auto settings = defaultSettings(myactuatorFamily(), "RMD-X8-25", 3);
  settings.scale_error = error;
  return {
      std::make_unique<MyActuator_Motor>(settings, myactuatorFamily().traits(settings.model, settings.own)),
      sim::makeMyactuatorDrive(settings, {})};
}

constexpr Target kVelocity{.mode = ControlMode::kVelocity, .value = static_cast<double>(kRpm)};
constexpr Target kMotion{
    .mode = ControlMode::kImpedance, .velocity_ff_rpm = kRpm, .damping_nms_per_rad = 4.0F};

struct Subject {
  const char* name;
  const char* family;
  SoloRig (*rig)(double error);
  Target target;
  void (*rescale)(CanFrame& frame, double ratio);
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

void rescaleState(CanFrame& frame, double ratio) {
  if (frame.data[0] >> 4U == 1) rescale(frame, 3, 12, ratio);  // enabled: no answer about a register
}

void rescaleMit(CanFrame& frame, double ratio) { rescale(frame, 3, 12, ratio); }

void rescaleMotion(CanFrame& frame, double ratio) {
  if (frame.id.value == myactuator::kMotionReplyBase + 3) rescale(frame, 3, 12, ratio);
}

void rescaleFeedback(CanFrame& frame, double ratio) {
  if (frame.id.value >> 24U == 2) rescale(frame, 2, 16, ratio);
}

const Subject kSubjects[] = {
    {"DamiaoMit", "Damiao", damiaoMit, kVelocity, rescaleState},
    {"DamiaoVelocity", "Damiao", damiaoVelocity, kVelocity, rescaleState},
    {"RobStride", "RobStride", robstride, kVelocity, rescaleFeedback},
    {"CubemarsMit", "CubeMars", cubemars, kVelocity, rescaleMit},
    {"MyActuatorMotion", "MyActuator", myactuator, kMotion, rescaleMotion},
};

class SpeedScale : public testing::TestWithParam<Subject> {
 protected:
  /// Complaint after a second of motion with a drive that reports so many times its speed.
  static DriveComplaint complaintAt(double ratio, double error = MotorSettings{}.scale_error) {
    SoloRig rig = GetParam().rig(error);
    rig.comeOnline();
    EXPECT_TRUE(rig.enable());
    rig.garble([ratio](CanFrame& frame) { GetParam().rescale(frame, ratio); });
    rig.command(GetParam().target);
    rig.run(seconds{1});
    EXPECT_GT(std::abs(rig.drive().physics().outputRpm()), 0.3 * static_cast<double>(kRpm)) << "it moved";
    return rig.motor().complaint();
  }
};

TEST_P(SpeedScale, ADriveOnAnotherScaleIsStoppedAtItsFirstMotion) {
  for (const double ratio : {1.3, 1.5, 0.7}) {
    SCOPED_TRACE(ratio);
    const auto complaint = complaintAt(ratio);
    EXPECT_EQ(complaint.fault, FaultCode::kDriveSetting);
    EXPECT_NEAR(static_cast<double>(complaint.native_code - SoloMotor::kSpeedScaleComplaint), 100.0 * ratio,
                5.0);
  }
}

TEST_P(SpeedScale, ADriveOnItsOwnScaleOrSomewhatOffIsNot) {
  for (const double ratio : {1.0, 1.15, 0.88}) {
    SCOPED_TRACE(ratio);
    EXPECT_EQ(complaintAt(ratio).fault, FaultCode::kNone);
  }
}

class EndOfASpeedField : public SpeedScale {};

TEST_P(EndOfASpeedField, TheSpeedTellsNoScaleThere) {
  SoloRig rig = GetParam().rig(MotorSettings{}.scale_error);
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.garble([](CanFrame& frame) { GetParam().rescale(frame, 1e6); });
  rig.command(GetParam().target);
  rig.run(seconds{1});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST_P(SpeedScale, TheThresholdIsTheUsersAndZeroIsNone) {
  EXPECT_EQ(complaintAt(1.15, 0.1).fault, FaultCode::kDriveSetting);
  EXPECT_EQ(complaintAt(1.3, 0.4).fault, FaultCode::kNone);
  EXPECT_EQ(complaintAt(3.0, 0.0).fault, FaultCode::kNone);
}

INSTANTIATE_TEST_SUITE_P(Families, SpeedScale, testing::ValuesIn(kSubjects),
                         [](const auto& each) { return std::string{each.param.name}; });

// That of a Damiao goes round at its ends (WrappedSpeed), and so does that of a CubeMars, unless a firmware
// cuts it off.
INSTANTIATE_TEST_SUITE_P(Families, EndOfASpeedField,
                         testing::Values(kSubjects[2], kSubjects[3], kSubjects[4]),
                         [](const auto& each) { return std::string{each.param.name}; });

// A family that reports shares of a range belongs into the table above.
TEST(SpeedScaleFamilies, EveryFamilyThatIsComparedHasATestAndNoOther) {
  std::set<std::string_view> compared;
  for (const auto& entry : builtInFamilies()) {
    auto own = ownDefaults(*entry.family);
    if (entry.family->name() == "CubeMars") own.set("protocol", std::string{"mit"});
    for (const auto model : entry.family->models()) {
      if (entry.family->traits(model, own).scaled_speed) compared.insert(entry.family->name());
    }
  }
  std::set<std::string_view> tested;
  for (const auto& subject : kSubjects) tested.insert(subject.family);
  EXPECT_EQ(compared, tested);
}

}  // namespace
}  // namespace rc10::test::speed_scale_test
