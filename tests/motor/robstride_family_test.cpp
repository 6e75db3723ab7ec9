#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/socket_pair.hpp"
#include "motor/robstride_bench.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::robstride_family_test {
namespace {

using namespace robstride_bench;

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
}  // namespace rc10::test::robstride_family_test
