// Every family: what it packs has room, what it tells of a command is what the frame says.
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/built_motor.hpp"
#include "sim/solo_rig.hpp"

namespace rc10::test::told_values_test {
namespace {

using namespace std::chrono_literals;

struct Subject {
  const char* name;
  const char* model;
  int id;
  OwnKeys own;
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

const Subject kSubjects[] = {
    {"Vesc", "VESC", 7, {{"pole_pairs", 7.0}, {"kv_rpm_per_v", 190.0}}},
    {"VescWithEncoder", "VESC", 7, {{"pole_pairs", 7.0}, {"kv_rpm_per_v", 190.0}, {"angle", "encoder"}}},
    {"DamiaoMit", "DM4310", 1, {{"master_id", 17.0}}},
    {"DamiaoVelocity", "DM4310", 1, {{"master_id", 17.0}, {"control", "velocity"}}},
    {"DamiaoPosition", "DM4310", 1, {{"master_id", 17.0}, {"control", "position_velocity"}}},
    {"DamiaoForce", "DM4310", 1, {{"master_id", 17.0}, {"control", "force_position"}}},
    {"RobStride", "RS00", 3, {}},
    {"RobStrideCurrent", "RS00", 3, {{"control", "current"}}},
    {"RobStrideVelocity", "RS00", 3, {{"control", "velocity"}}},
    {"RobStridePosition", "RS00", 3, {{"control", "position"}}},
    {"CubeMarsServo", "AK80-9", 5, {}},
    {"CubeMarsMit", "AK80-9", 5, {{"protocol", "mit"}}},
    {"Moteus", "moteus", 1, {{"motor_kv_rpm_per_v", 304.0}}},
    {"OdriveS1", "ODrive_S1", 3, {{"torque_constant_nm_per_a", 0.05}}},
    {"OdriveV3", "ODrive_v3", 3, {{"torque_constant_nm_per_a", 0.05}}},
    {"MyActuator", "RMD-X8-20", 3, {}},
    {"LkTech", "LK-MG5010E-i10", 3, {}},
};

class Built : public BuiltMotor {
 public:
  explicit Built(const Subject& subject) : BuiltMotor(subject.model, subject.id, subject.own) {
    const auto own = traits();
    settings().effort_limit = own.effort_full_scale > 0.0F ? 0.5F * own.effort_full_scale : 10.0F;
    if (settings().model.starts_with("ODrive")) settings().velocity_limit_rpm = 600.0F;  // it must be given
    if (own.host_loops != nullptr) settings().loops = *own.host_loops;
  }
  [[nodiscard]] double limit() { return static_cast<double>(settings().effort_limit); }
};

class ToldValues : public ::testing::TestWithParam<Subject> {
 protected:
  bool activate() {
    rig_.comeOnline();
    rig_.run(2000ms);  // some start slowly
    return rig_.enable();
  }
  void follow(const Target& target) {
    rig_.command(target);
    rig_.run(3ms);
  }
  [[nodiscard]] double told() { return static_cast<double>(rig_.motor().commandValue()); }

  Built built_{GetParam()};
  SoloRig rig_{built_.motor(), built_.drive()};
};

TEST_P(ToldValues, NoFrameIsWrittenBeyondTheRoomThatThereIs) {
  Built apart{GetParam()};
  const auto motor = apart.motor();
  const CanFrame untouched = makeClassicFrame({0x7EF, false}, std::array<std::uint8_t, 1>{0x5A});
  std::uint64_t ticks = 0;
  for (int kind = 0; kind <= static_cast<int>(FrameKind::kCommand); ++kind) {
    for (std::size_t room = 0; room <= kMaxFramesPerPacker; ++room) {
      std::array<CanFrame, kMaxFramesPerPacker + 1> frames{};
      frames.fill(untouched);
      motor->order(static_cast<FrameKind>(kind));
      const Tick tick{.index = ++ticks, .now = MonotonicTime{ticks * 1ms}, .dt_s = 0.001F};
      motor->update(tick);
      EXPECT_LE(motor->packCommand(tick, std::span{frames}.first(room)), room);
      for (std::size_t i = room; i < frames.size(); ++i) EXPECT_EQ(frames[i].id, untouched.id);
      frames.fill(untouched);
      const std::size_t rests = motor->packRest(std::span{frames}.first(room));
      EXPECT_LE(rests, room);
      EXPECT_EQ(rests > 0, room > 0) << "rest leaves wherever one frame can";
      for (std::size_t i = room; i < frames.size(); ++i) EXPECT_EQ(frames[i].id, untouched.id);
    }
  }
}

TEST_P(ToldValues, ATargetBeyondWhatAFrameCanSayIsToldAsTheFrameSaysIt) {
  constexpr double kMostToldByAnyFrame = 1e11;
  ASSERT_TRUE(activate());
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kTotalAngle, ControlMode::kCurrent}) {
    if (!rig_.motor().modes().contains(mode)) continue;
    for (const double value : {1e20, -1e20}) {
      SCOPED_TRACE(std::string{toString(mode)} + " " + std::to_string(value));
      follow({.mode = mode, .value = value});
      EXPECT_LT(std::fabs(told()), kMostToldByAnyFrame);
      // A place is told step by step where the shortest way would be another.
      EXPECT_TRUE(mode == ControlMode::kTotalAngle || told() == 0.0 || rig_.motor().limits() != 0U);
      follow({});
    }
  }
}

TEST_P(ToldValues, ATargetThatTheFrameCanSayIsToldInTheUnitOfItsMode) {
  ASSERT_TRUE(activate());
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kTotalAngle}) {
    if (!rig_.motor().modes().contains(mode)) continue;
    follow({.mode = mode, .value = 20.0});
    const bool by_host = mode == ControlMode::kTotalAngle && std::string{GetParam().name} == "Vesc";
    if (rig_.motor().commandUnit() == CommandUnit::kNative && !by_host) {
      EXPECT_NEAR(told(), 20.0, 0.01) << toString(mode);
    }
    follow({});
  }
}

// Against a wall, so that the winding has what it is told for as long as one likes.
TEST_P(ToldValues, InEachModeTheValueIsInTheUnitThatIsToldWithIt) {
  ASSERT_TRUE(activate());
  rig_.stall(true);
  for (int i = 0; i < kControlModeCount; ++i) {
    const auto mode = static_cast<ControlMode>(i);
    if (!rig_.motor().modes().contains(mode)) continue;
    SCOPED_TRACE(toString(mode));
    Target target{.mode = mode, .value = 5.0};
    if (mode == ControlMode::kCurrent) target.value = 0.3 * built_.limit();
    if (mode == ControlMode::kDuty) target.value = 0.1;
    if (mode == ControlMode::kImpedance) target.stiffness_nm_per_rad = 5.0F;
    follow(target);
    rig_.run(50ms);
    // A drive of speeds or angles coasts by one of them.
    const bool drives_loop = mode == ControlMode::kCoast || mode == ControlMode::kVelocity ||
                             mode == ControlMode::kAngle || mode == ControlMode::kTotalAngle ||
                             mode == ControlMode::kDuty || mode == ControlMode::kBrake;
    switch (rig_.motor().commandUnit()) {
      case CommandUnit::kAmpere:
        EXPECT_NEAR(told(), rig_.drive().physics().currentA(), 0.02 * built_.limit());
        EXPECT_TRUE(mode != ControlMode::kImpedance || told() > 0.01 * built_.limit());
        break;
      case CommandUnit::kNative: EXPECT_TRUE(drives_loop) << "its unit is that of the mode"; break;
      case CommandUnit::kNone: EXPECT_EQ(told(), 0.0); break;
      case CommandUnit::kVolt: ADD_FAILURE() << "none of these drives is told a voltage"; break;
    }
    follow({});
  }
}

class ToldCurrents : public ToldValues {};

TEST_P(ToldCurrents, AFeedForwardOfAnySizeIsBoundedByTheCurrentLimit) {
  ASSERT_TRUE(activate());
  constexpr float kMost = std::numeric_limits<float>::max();
  follow({.mode = ControlMode::kCurrent, .torque_ff_nm = kMost});
  EXPECT_NEAR(told(), built_.limit(), 1e-3 * built_.limit());
  EXPECT_NE(rig_.motor().limits() & kLimitCurrent, 0U);
  follow({.mode = ControlMode::kCurrent, .torque_ff_nm = -kMost});
  EXPECT_NEAR(told(), -built_.limit(), 1e-3 * built_.limit());
}

std::vector<Subject> withCurrents() {
  std::vector<Subject> with;
  for (const auto& subject : kSubjects)
    if (Built{subject}.motor()->modes().contains(ControlMode::kCurrent)) with.push_back(subject);
  return with;
}

INSTANTIATE_TEST_SUITE_P(All, ToldCurrents, ::testing::ValuesIn(withCurrents()),
                         [](const auto& subject) { return std::string{subject.param.name}; });

INSTANTIATE_TEST_SUITE_P(All, ToldValues, ::testing::ValuesIn(kSubjects),
                         [](const auto& subject) { return std::string{subject.param.name}; });

}  // namespace
}  // namespace rc10::test::told_values_test
