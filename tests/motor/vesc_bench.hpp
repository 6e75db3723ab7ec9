#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "app/angle.hpp"
#include "bus/byte_order.hpp"
#include "drives/vesc/vesc_family.hpp"
#include "support/alloc_guard.hpp"
#include "support/vesc_motors.hpp"

namespace rc10::test::vesc_bench {

using std::chrono::milliseconds;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline const std::string kNone{"none"};
inline const std::string kEncoder{"encoder"};

/// One VESC, ticks and frames by hand.
class VescMotorTest : public ::testing::Test {
 protected:
  VESC_Motor& make(const MotorSettings& settings) {
    motor_ = std::make_unique<VESC_Motor>(settings);
    return *motor_;
  }
  VESC_Motor& makeWith(const std::vector<std::pair<std::string, OwnValues::Value>>& own = {}) {
    auto with = own;
    with.insert(with.begin(), {"ask_status", 0.0});
    return make(vescSettings(with));
  }
  /// At rest, its tachometer at 1000 steps.
  VESC_Motor& makeZeroedAt(double angle_deg) {
    auto& motor = makeWith();
    status(0);
    steps(1000);
    EXPECT_TRUE(motor.setZero(angle_deg));
    return motor;
  }
  std::vector<CanFrame> tick(Duration dt = milliseconds{1}) {
    tick_.now += dt;
    ++tick_.index;
    motor_->update(tick_);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_->packCommand(tick_, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  FrameVerdict give(CanFrame frame) {
    frame.received = tick_.now;
    return motor_->matchesFrame(frame) ? motor_->updateFeedback(frame) : FrameVerdict::kMalformed;
  }
  void status(std::int32_t erpm, double current_a = 0.0, double duty = 0.0) {
    CanFrame frame = vescFrame(0x907, "0000000000000000");
    writeBigEndian<std::int32_t>(frame.data, 0, erpm);
    writeBigEndian<std::int16_t>(frame.data, 4, static_cast<std::int16_t>(std::lround(current_a * 10.0)));
    writeBigEndian<std::int16_t>(frame.data, 6, static_cast<std::int16_t>(std::lround(duty * 1000.0)));
    ASSERT_EQ(give(frame), FrameVerdict::kAccepted);
  }
  void steps(std::int32_t count) {
    CanFrame frame = vescFrame(0x1B07, "0000000000F00000");
    writeBigEndian<std::int32_t>(frame.data, 0, count);
    ASSERT_EQ(give(frame), FrameVerdict::kAccepted);
  }
  void encoder(double deg) {
    CanFrame frame = vescFrame(0x1007, "0000000000000000");
    writeBigEndian<std::int16_t>(frame.data, 6, static_cast<std::int16_t>(std::lround(deg * 50.0)));
    ASSERT_EQ(give(frame), FrameVerdict::kAccepted);
  }
  /// The command for this target in one tick: the raw value, and its packet.
  std::int32_t sent(const Target& target) {
    motor_->order(FrameKind::kCommand, target);
    return sent();
  }
  std::int32_t sent() {
    const auto frames = tick();
    EXPECT_EQ(frames.size(), 1U);
    if (frames.empty()) return 0;
    EXPECT_EQ(frames[0].length, 4);
    EXPECT_EQ(frames[0].id.value & 0xFFU, 7U);
    packet_ = static_cast<vesc::Packet>(frames[0].id.value >> 8U);
    return readBigEndian<std::int32_t>(frames[0].payload(), 0);
  }

  std::unique_ptr<VESC_Motor> motor_;
  Tick tick_{.index = 0, .now = MonotonicTime{std::chrono::hours{1}}};
  vesc::Packet packet_ = vesc::Packet::kPing;
};

}  // namespace rc10::test::vesc_bench
