#pragma once

#include <array>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "drives/odrive/odrive_family.hpp"
#include "support/odrive_settings.hpp"

namespace rc10::test::odrive_bench {

using namespace std::chrono_literals;
using testing::HasSubstr;

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

class OdriveMotor : public testing::Test {
 protected:
  void make(const MotorSettings& settings) {
    node_ = settings.id;
    motor_ = odriveMotor(settings);
  }
  void SetUp() override { make(odriveSettings()); }

  FrameVerdict feed(odrive::Message message, float first, float second) {
    std::array<std::uint8_t, 8> payload{};
    writeLittleEndian(std::span<std::uint8_t>{payload}, 0, first);
    writeLittleEndian(std::span<std::uint8_t>{payload}, 4, second);
    return feed(message, payload);
  }
  FrameVerdict feed(odrive::Message message, std::span<const std::uint8_t> payload) {
    CanFrame frame = makeClassicFrame(odrive::canId(node_, message), payload);
    frame.received = now_;
    return motor_->updateFeedback(frame);
  }
  FrameVerdict heartbeat(std::uint32_t error, std::uint8_t state, std::array<std::uint8_t, 3> flags = {}) {
    std::array<std::uint8_t, 8> payload{};
    writeLittleEndian(std::span<std::uint8_t>{payload}, 0, error);
    payload[4] = state;
    std::copy(flags.begin(), flags.end(), payload.begin() + 5);
    return feed(odrive::Message::kHeartbeat, payload);
  }
  void sample(float turns = 0.0F, float turns_per_s = 0.0F) {
    EXPECT_EQ(feed(odrive::Message::kEncoderEstimates, turns, turns_per_s), FrameVerdict::kAccepted);
  }

  std::vector<CanFrame> tick() {
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_->update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_->packCommand(tick, out);
    now_ += 1ms;
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }

  void enable() {
    heartbeat(0, 1);
    sample();
    motor_->order(FrameKind::kEnable);
    tick();
    tick();
    heartbeat(0, 8);
    tick();
    ASSERT_EQ(motor_->sequenceProgress(), SequenceProgress::kDone);
  }

  /// The last frame of the tick in which the drive has been told the mode often enough.
  CanFrame settledInput(const Target& target) {
    motor_->order(FrameKind::kCommand);
    EXPECT_TRUE(motor_->setTarget(target));
    for (int i = 0; i < 5; ++i) tick();
    const auto frames = tick();
    EXPECT_FALSE(frames.empty());
    return frames.empty() ? CanFrame{} : frames.back();
  }
  static float numberAt(const CanFrame& frame, std::size_t at) {
    return readLittleEndian<float>(frame.payload(), at);
  }
  static std::vector<odrive::Message> messages(const std::vector<CanFrame>& frames) {
    std::vector<odrive::Message> result;
    for (const auto& frame : frames) result.push_back(odrive::messageOf(frame.id));
    return result;
  }
  void expectRest(const std::vector<CanFrame>& frames) {
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].id, odrive::canId(node_, odrive::Message::kSetInputTorque));
    EXPECT_EQ(numberAt(frames[0], 0), 0.0F);
    EXPECT_EQ(frames[1].id, odrive::canId(node_, odrive::Message::kSetAxisState));
    EXPECT_EQ(frames[1].data[0], 1);
  }

  /// Rest, and that its inputs of before are gone before any torque is possible.
  void expectIdleAsked(const std::vector<CanFrame>& frames) {
    ASSERT_EQ(frames.size(), 4U);
    EXPECT_EQ(frames[0].id, odrive::canId(node_, odrive::Message::kSetInputVel));
    EXPECT_EQ(numberAt(frames[0], 0), 0.0F);
    EXPECT_EQ(frames[1].id, odrive::canId(node_, odrive::Message::kSetControllerMode));
    EXPECT_EQ(frames[1].data[0], 1) << "torque";
    expectRest({frames[2], frames[3]});
  }

  int node_ = 0;
  std::unique_ptr<ODrive_Motor> motor_;
  MonotonicTime now_{1h};
  std::uint64_t ticks_ = 0;
};

}  // namespace rc10::test::odrive_bench
