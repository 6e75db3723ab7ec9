// A drive keeps its last frame when its cable tears. That of damp or brake has to resist then, too.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/units.hpp"
#include "drives/families.hpp"
#include "sim/built_motor.hpp"
#include "sim/solo_rig.hpp"

namespace rc10::test::frozen_frame_test {
namespace {

using namespace std::chrono_literals;

struct Subject {
  const char* name;
  const char* model;
  int id;
  float limit_a;
  double fast_rpm;      ///< Full damping would be more than the limit there.
  double damping_step;  ///< One step of its field, Nms/rad; 0: it has none.
  FrameKind shorts;     ///< The kind that shorts the winding, which no limit bounds; kRest: none.
  OwnKeys own;
  bool nearest = false;  ///< Its fields are rounded, not cut off.
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

constexpr double kTwelveBits = 5.0 / 4095.0;
constexpr auto kNone = FrameKind::kRest;

const Subject kSubjects[] = {
    {"DamiaoMit", "DM4310", 1, 2.0F, 180.0, kTwelveBits, kNone, {{"master_id", 17.0}}},
    {"DamiaoMitHub",
     "DMH6215",
     1,
     1.0F,
     250.0,
     kTwelveBits,
     kNone,
     {{"master_id", 17.0}, {"velocity_damping_nms_per_rad", 1.0}}},
    {"RobStride", "RS00", 3, 2.0F, 290.0, 5.0 / 65535.0, kNone, {}},
    {"RobStrideOfAWideScale",
     "RS03",
     3,
     4.0F,
     180.0,
     100.0 / 65535.0,
     kNone,
     {{"velocity_gain_nms_per_rad", 100.0}}},
    {"CyberGear", "CyberGear", 3, 2.0F, 250.0, 5.0 / 65535.0, kNone, {}},
    {"CubeMarsServo", "AK80-9", 5, 4.0F, 300.0, 0.0, FrameKind::kDamp, {}},
    {"CubeMarsMit", "AK80-9", 5, 4.0F, 300.0, kTwelveBits, kNone, {{"protocol", "mit"}}},
    {"CubeMarsMitV3", "AK80-8-V3", 5, 4.0F, 300.0, kTwelveBits, kNone, {{"protocol", "mit_v3"}}},
    {"MyActuator", "RMD-X8-20", 3, 2.0F, 180.0, kTwelveBits, kNone, {}, true},
    {"Moteus", "moteus", 1, 4.0F, 1500.0, 0.0, FrameKind::kBrake, {{"motor_kv_rpm_per_v", 100.0}}},
    {"Vesc", "VESC", 7, 8.0F, 3000.0, 0.0, kNone, {{"pole_pairs", 7.0}, {"kv_rpm_per_v", 190.0}}},
};

class FrozenFrame : public ::testing::TestWithParam<Subject> {
 protected:
  FrozenFrame() {
    built_.settings().effort_limit = GetParam().limit_a;
    rig_ = std::make_unique<SoloRig>(built_.motor(), built_.drive());
  }

  [[nodiscard]] sim::MotorPhysics& shaft() { return rig_->drive().physics(); }
  /// A hand that is stronger than any motor; at 0 a wall.
  void turnAt(double rpm) {
    shaft().stall(rpm == 0.0);
    if (rpm == 0.0) return;
    shaft().take({.by_deg = rpm * 6.0 * 1e3, .speed_rpm = std::fabs(rpm), .torque_nm = 1e3, .hold = 1h});
  }
  [[nodiscard]] double limitNm(double share) const {
    return share * static_cast<double>(GetParam().limit_a * traits_.torque_nm_per_a);
  }

  void activate() {
    rig_->comeOnline();
    rig_->run(2000ms);  // some start slowly
    ASSERT_TRUE(rig_->enable());
  }
  /// The frames of one tick, at this speed and with this share of the limit.
  std::vector<CanFrame> framesAt(double rpm, FrameKind kind, double share) {
    rig_->motor().derate(static_cast<float>(share));
    rig_->motor().order(kind);
    turnAt(rpm);
    rig_->run(500ms);
    (void)rig_->takeSent();
    rig_->run(2ms);  // a tick may be another motor's
    return rig_->takeSent();
  }
  /// Torque of the drive at this speed while it keeps these frames.
  double torqueNm(const std::vector<CanFrame>& frames, double rpm) {
    turnAt(rpm);
    for (int ms = 0; ms < 300; ++ms) {
      for (const auto& frame : frames) rig_->drive().receive(frame);
      rig_->drive().step(1ms);
    }
    std::array<CanFrame, sim::Drive::kMaxFrames> unheard{};
    (void)rig_->drive().answers(unheard);
    EXPECT_NEAR(shaft().outputRpm(), rpm, 0.02 * GetParam().fast_rpm);
    return shaft().outputTorqueNm();
  }
  void expectResistance(FrameKind kind, double share, double fast_rpm) {
    const auto frames = framesAt(fast_rpm, kind, share);
    ASSERT_FALSE(frames.empty());
    const double most_nm = limitNm(share);
    const double rounded_nm = 0.02 * limitNm(1.0);
    EXPECT_GT(std::fabs(torqueNm(frames, fast_rpm)), 0.5 * most_nm);
    for (int tenths = 10; tenths > 0; --tenths) {
      const double rpm = 0.1 * tenths * fast_rpm;
      const double against_nm = -torqueNm(frames, rpm) * std::copysign(1.0, rpm);
      EXPECT_GT(against_nm, 0.0) << "it pushes at " << rpm << " rpm";
      if (GetParam().shorts != kind) {
        EXPECT_LT(against_nm, most_nm + rounded_nm) << rpm << " rpm";
      }
    }
    // A brake that is no law with a gain may hold what stands still.
    EXPECT_NEAR(torqueNm(frames, 0.0), 0.0, GetParam().damping_step > 0.0 ? rounded_nm : most_nm);
  }

  BuiltMotor built_{GetParam().model, GetParam().id, GetParam().own};
  MotorTraits traits_ = built_.traits();
  std::unique_ptr<SoloRig> rig_;
};

TEST_P(FrozenFrame, OfDampAndBrakeResistsAtEverySpeedAndPushesAtNone) {
  activate();
  for (const auto kind : {FrameKind::kDamp, FrameKind::kBrake}) {
    if (!resists(kind, traits_.frames)) continue;
    for (const double share : {1.0, 0.25}) {
      for (const double sign : {1.0, -1.0}) {
        SCOPED_TRACE(testing::Message()
                     << (kind == FrameKind::kDamp ? "damp, " : "brake, ") << share << ", " << sign);
        expectResistance(kind, share, sign * GetParam().fast_rpm);
      }
    }
  }
}

// Below half a step the field says none: the shaft runs down by its friction.
TEST_P(FrozenFrame, OfDampKeepsOneStepOfTheGainDownToHalfOfItsTorque) {
  const double step_nm = GetParam().damping_step * GetParam().fast_rpm * kRadPerSPerRpm;
  if (step_nm == 0.0) return;  // no field of a gain
  activate();
  for (const auto& [steps, kept] : {std::pair{1.6, 1.0}, {0.6, 1.0}, {0.4, 0.0}}) {
    SCOPED_TRACE(steps);
    const auto frames = framesAt(GetParam().fast_rpm, FrameKind::kDamp, steps * step_nm / limitNm(1.0));
    const double rounded = GetParam().nearest ? std::round(steps) : kept;
    EXPECT_NEAR(torqueNm(frames, 0.0) - torqueNm(frames, GetParam().fast_rpm), rounded * step_nm,
                0.02 * step_nm);
  }
}

TEST(FrozenFrameOfEveryFamily, WithALawThatOnlyResistsIsAmongTheSubjects) {
  std::set<std::string_view> resisting;
  std::set<std::string_view> here;
  for (const auto& entry : builtInFamilies()) {
    for (const auto model : entry.family->models()) {
      const auto frames = entry.family->traits(model, ownDefaults(*entry.family)).frames;
      const bool own = frames.damp == Provision::kFrame || resists(FrameKind::kBrake, frames);
      if (own) resisting.insert(entry.family->name());
    }
  }
  for (const auto& subject : kSubjects) here.insert(familyOf(subject.model).family->name());
  EXPECT_EQ(here, resisting);
}

INSTANTIATE_TEST_SUITE_P(Families, FrozenFrame, ::testing::ValuesIn(kSubjects),
                         [](const auto& which) { return std::string{which.param.name}; });

}  // namespace
}  // namespace rc10::test::frozen_frame_test
