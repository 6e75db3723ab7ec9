#include "sim/load_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "drives/dji/dji_simulated.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_rig.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::load_change_test {
namespace {

using namespace std::chrono_literals;
using sim::kLoadFigures;
using sim::LoadChange;
using sim::LoadPlan;
using sim::MotorLoad;
using sim::SimBus;
using sim::SimBusConfig;

LoadChange changeOf(float MotorLoad::*field, float value) {
  LoadChange change;
  for (std::size_t i = 0; i < kLoadFigures.size(); ++i) {
    if (kLoadFigures[i].field == field) change.values[i] = value;
  }
  return change;
}

TEST(LoadChange, LeavesWhatItDoesNotGiveAsItWas) {
  const MotorLoad start{.inertia_kg_m2 = 0.01F, .gravity_nm = 1.0F, .stop_max_deg = 90.0F};
  MotorLoad now = start;
  now.gravity_nm = 3.0F;
  now.lost_frames = 0.5F;
  const MotorLoad changed = changeOf(&MotorLoad::payload_kg, 2.0F).of(now, start);
  EXPECT_EQ(changed.payload_kg, 2.0F);
  EXPECT_EQ(changed.gravity_nm, 3.0F);
  EXPECT_EQ(changed.inertia_kg_m2, 0.01F);
  EXPECT_EQ(changed.lost_frames, 0.5F);
}

TEST(LoadChange, BackIsTheLoadOfTheStartAndLeavesFaultsAlone) {
  const MotorLoad start{.inertia_kg_m2 = 0.01F, .gravity_nm = 1.0F};
  MotorLoad now = start;
  for (const auto& figure : kLoadFigures) now.*figure.field = 7.0F;
  now.silent = true;
  const MotorLoad back = LoadChange{.back = true}.of(now, start);
  EXPECT_EQ(back.inertia_kg_m2, 0.01F);
  EXPECT_EQ(back.gravity_nm, 1.0F);
  EXPECT_EQ(back.payload_kg, 0.0F);
  EXPECT_TRUE(back.silent);
}

SimBusConfig oneArm(LoadPlan plan) {
  SimBusConfig config;
  config.drives = {sim::djiDrive({"arm", &kM3508, 1, DjiCommand::kCurrent, 0.0, {.gravity_nm = 0.5F}})};
  config.plans = {std::move(plan)};
  return config;
}

/// Gravity of the arm, each millisecond.
std::vector<float> gravities(SimBus& bus, int ms) {
  std::vector<float> seen;
  std::vector<CanFrame> out(SimBus::kMaxFramesPerStep);
  for (int i = 1; i <= ms; ++i) {
    bus.step(MonotonicTime{i * 1ms}, 1ms, out);
    seen.push_back(bus.drive(0).load().gravity_nm);
  }
  return seen;
}

LoadPlan risingAt2And4Ms(Duration repeat) {
  return {
      .steps = {{2ms, changeOf(&MotorLoad::gravity_nm, 1.0F)}, {4ms, changeOf(&MotorLoad::gravity_nm, 2.0F)}},
      .repeat = repeat};
}

TEST(LoadPlan, ItsChangesComeOnceAtTheirTimes) {
  SimBus bus{oneArm(risingAt2And4Ms(0ms))};
  EXPECT_EQ(gravities(bus, 7), (std::vector{0.5F, 1.0F, 1.0F, 2.0F, 2.0F, 2.0F, 2.0F}));
}

TEST(LoadPlan, BeginsAnewWithTheLoadOfTheStart) {
  SimBus bus{oneArm(risingAt2And4Ms(5ms))};
  EXPECT_EQ(gravities(bus, 12),
            (std::vector{0.5F, 1.0F, 1.0F, 2.0F, 0.5F, 0.5F, 1.0F, 1.0F, 2.0F, 0.5F, 0.5F, 1.0F}));
}

TEST(LoadPlan, ALateStepMakesUpForAllThatWereDue) {
  SimBus bus{oneArm(risingAt2And4Ms(5ms))};
  std::vector<CanFrame> out(SimBus::kMaxFramesPerStep);
  bus.step(MonotonicTime{9ms}, 9ms, out);
  EXPECT_EQ(bus.drive(0).load().gravity_nm, 2.0F);
  bus.step(MonotonicTime{11ms}, 2ms, out);
  EXPECT_EQ(bus.drive(0).load().gravity_nm, 0.5F);
}

TEST(LoadPlan, ChangingALoadAllocatesNothing) {
  SimBus bus{oneArm(risingAt2And4Ms(5ms))};
  std::vector<CanFrame> out(SimBus::kMaxFramesPerStep);
  AllocGuard guard;
  for (int i = 1; i <= 20; ++i) bus.step(MonotonicTime{i * 1ms}, 1ms, out);
  bus.changeLoad(0, changeOf(&MotorLoad::coulomb_nm, 1.0F));
  EXPECT_EQ(guard.allocations(), 0U);
}

// An arm that stands level: its loop carries what it picks up, and is where it was after a sag.
TEST(LoadChange, ALoopCarriesAPayloadThatIsPickedUpAndPutDown) {
  constexpr double kTorqueNm = 0.5 * 9.80665 * 0.2;
  SimRigConfig config;
  config.drives = {{"arm", &kM3508, 3, DjiCommand::kCurrent, 0.0,
                    MotorLoad{.coulomb_nm = 0.0F, .hangs_at_deg = -90.0F, .payload_at_m = 0.2F}}};
  SimRig rig{config};
  rig.run(20ms);
  rig.command(0, {.mode = ControlMode::kTotalAngle, .value = rig.motor(0).feedback().total_angle_deg});
  rig.run(1s);
  ASSERT_NEAR(rig.truth(0).currentA(), 0.0, 0.05);
  rig.port().bus().changeLoad(0, changeOf(&MotorLoad::payload_kg, 0.5F));
  double lowest_deg = 0.0;
  rig.run(2s, [&] { lowest_deg = std::min(lowest_deg, rig.truth(0).outputAngleDeg()); });
  EXPECT_LT(lowest_deg, -0.05);
  EXPECT_NEAR(rig.truth(0).outputTorqueNm(), kTorqueNm, 0.05 * kTorqueNm);
  EXPECT_NEAR(rig.truth(0).outputAngleDeg(), 0.0, 1.0);
  rig.port().bus().changeLoad(0, LoadChange{.back = true});
  rig.run(2s);
  EXPECT_NEAR(rig.truth(0).currentA(), 0.0, 0.05);
}

}  // namespace
}  // namespace rc10::test::load_change_test
