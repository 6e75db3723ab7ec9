// Samples that beat against the tick, arrive late, twice or not at all.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "drives/dji/dji_group.hpp"
#include "support/alloc_guard.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test::dji_timing_test {
namespace {

using std::chrono::microseconds;

struct Efforts {
  float lowest = 1e9F;
  float highest = -1e9F;
  int kept = 0;  ///< Ticks without a new sample.
};

/// A rotor that gains 20 rpm per millisecond, as seen by a motor with a derivative in its loop:
/// without disturbance its effort is constant. Samples come every `period` and `lateness(n)` later.
Efforts efforts(CascadeConfig loops, Duration period, const std::function<Duration(int)>& lateness) {
  MotorSettings config = djiConfig(kM3508);
  config.gear_ratio = 1.0;
  config.loops = std::move(loops);
  DJI_Motor motor(config);
  motor.order(FrameKind::kCommand);
  EXPECT_TRUE(motor.setTarget({.mode = ControlMode::kVelocity}));
  Efforts result;
  int sample = 0;
  for (int tick = 1; tick <= 1200; ++tick) {
    const MonotonicTime now{Duration{microseconds{1000}} * tick};
    const int before = sample;
    while (period * sample + lateness(sample) <= now.time_since_epoch()) {
      const double taken_ms = std::chrono::duration<double, std::milli>(period * sample).count();
      const double rpm = -12'000.0 + 20.0 * taken_ms;
      const double turns = (-12'000.0 * taken_ms + 10.0 * taken_ms * taken_ms) / 60e3;
      const auto position =
          static_cast<std::uint16_t>(static_cast<int>((turns - std::floor(turns)) * 8192.0) % 8192);
      (void)motor.updateFeedback(makeDjiFeedback(
          kM3508, 1, {.position = position, .rpm = static_cast<std::int16_t>(std::lround(rpm))},
          MonotonicTime{period * sample + lateness(sample)}));
      ++sample;
    }
    motor.update(Tick{.index = static_cast<std::uint64_t>(tick), .now = now, .dt_s = 0.001F});
    if (tick < 200) continue;  // start-up glide and filters
    if (sample == before) ++result.kept;
    result.lowest = std::min(result.lowest, motor.commandValue());
    result.highest = std::max(result.highest, motor.commandValue());
  }
  return result;
}

CascadeConfig derivativeOnly() {
  return {.velocity = PID_Position::Config{.kd = 0.0005F}, .angle = {}, .velocity_limit_rpm = 0.0F};
}
constexpr float kExpected = -10.0F;  // 0.0005 A s/rpm * 20,000 rpm/s

Duration onTime(int /*sample*/) { return Duration{0}; }
Duration jittering(int sample) { return microseconds{(sample * 7919) % 300}; }

TEST(DjiTiming, FeedbackThatBeatsAgainstTheTickNeverAlternatesBetweenZeroAndDouble) {
  for (const int period_us : {990, 997, 1000, 1003, 1010}) {
    for (const auto& lateness : {onTime, jittering}) {
      const Efforts result = efforts(derivativeOnly(), microseconds{period_us}, lateness);
      EXPECT_GT(result.lowest, 1.15F * kExpected) << period_us;
      EXPECT_LT(result.highest, 0.85F * kExpected) << period_us;
    }
  }
}

TEST(DjiTiming, TicksWithoutASampleKeepTheOutput) {
  const Efforts result = efforts(derivativeOnly(), microseconds{1010}, onTime);
  EXPECT_GT(result.kept, 5);  // the case does occur
  const Efforts slow = efforts(derivativeOnly(), microseconds{2000}, onTime);
  EXPECT_GT(slow.kept, 400);
  EXPECT_GT(slow.lowest, 1.15F * kExpected);
  EXPECT_LT(slow.highest, 0.85F * kExpected);
}

TEST(DjiTiming, LostFramesDoNotDisturbTheDerivative) {
  // Every seventh frame comes together with the next one.
  const auto paired = [](int sample) { return sample % 7 == 6 ? microseconds{999} : microseconds{0}; };
  const Efforts result = efforts(derivativeOnly(), microseconds{1000}, paired);
  EXPECT_GT(result.lowest, 1.15F * kExpected);
  EXPECT_LT(result.highest, 0.85F * kExpected);
}

TEST(DjiTiming, StampsThatNeverAdvanceCountAsTheNominalPeriod) {
  MotorSettings config = djiConfig(kM3508);
  config.loops = {.velocity = PID_Position::Config{.ki = 1.0F}, .angle = {}, .velocity_limit_rpm = 0.0F};
  DJI_Motor motor(config);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{10.0}));
  for (int i = 0; i < 500; ++i) {
    (void)motor.updateFeedback(makeDjiFeedback(kM3508, 1, {}));
    motor.update(Tick{});
  }
  EXPECT_GT(motor.commandValue(), 0.4F);
  EXPECT_LT(motor.commandValue(), 5.1F);
}

TEST(DjiTiming, ATickAllocatesNothing) {
  std::vector<std::unique_ptr<DJI_Motor>> motors;
  DJI_Group group({0x200, false});
  for (int id = 1; id <= 4; ++id) {
    motors.push_back(std::make_unique<DJI_Motor>(djiConfig(id % 2 == 0 ? kM3508 : kM2006, id)));
    ASSERT_TRUE(group.registerMotor(*motors.back()));
  }
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  std::size_t packed = 0;
  const AllocGuard guard;
  for (int tick = 0; tick < 1000; ++tick) {
    for (auto& motor : motors) {
      const MonotonicTime now{microseconds{1000} * tick};
      (void)motor->updateFeedback(makeDjiFeedback(motor->model(), motor->driveId(), {.rpm = 100}, now));
      motor->order(tick % 100 < 50 ? FrameKind::kCommand : FrameKind::kHold);
      (void)motor->setTarget({.mode = static_cast<ControlMode>(tick % kControlModeCount), .value = 5.0});
      motor->update(Tick{});
    }
    packed += group.packCommand(Tick{}, out) + group.packRest(out);
  }
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_EQ(packed, 2000U);
}

}  // namespace
}  // namespace rc10::test::dji_timing_test
