#pragma once

#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_model.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "support/frame_bytes.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::myactuator_bench {

using myactuator::Code;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline const std::string kOff = "141#8000000000000000";
inline const std::string kRead = "141#9C00000000000000";

inline MotorSettings settingsOf(std::string model = "RMD-X8-25") {
  MotorSettings settings;
  settings.name = "joint";
  settings.model = std::move(model);
  settings.id = 1;
  settings.own = ownDefaults(myactuatorFamily());
  return settings;
}

inline MyActuator_Motor motorOf(const MotorSettings& settings) {
  return MyActuator_Motor(settings, myactuatorFamily().traits(settings.model, settings.own));
}

inline CanFrame angleReply(std::int32_t raw) { return frameOf("241#9200000000000000", 4, raw); }

inline CanFrame uptimeReply(std::uint32_t ms) { return frameOf("241#B100000000000000", 4, ms); }

/// Hands frames over at 1 ms spacing, answering nothing by itself.
class MyActuatorMotor : public testing::Test {
 protected:
  explicit MyActuatorMotor(const MotorSettings& settings = settingsOf()) : motor_(motorOf(settings)) {}

  FrameVerdict hear(CanFrame frame) {
    frame.received = now_;
    EXPECT_TRUE(motor_.matchesFrame(frame));
    return motor_.updateFeedback(frame);
  }
  std::vector<std::string> tick() {
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_.packCommand(tick, out);
    std::vector<std::string> sent;
    for (std::size_t i = 0; i < count; ++i) sent.push_back(textOf(out[i]));
    return sent;
  }
  void pass(Duration duration) { now_ += duration; }
  /// As a drive that has been running for a while.
  void comeOnline(std::int32_t raw_angle = 1000) {
    hear(frameOf("241#9A1E0000E0010000"));  // 30 degC, 48 V
    hear(uptimeReply(uptime_ms_));
    hear(angleReply(raw_angle));
  }
  std::string told(const Target& target) {
    motor_.order(FrameKind::kCommand, target);
    return tick().at(0);
  }

  MyActuator_Motor motor_;
  MonotonicTime now_{std::chrono::hours{1}};
  std::uint64_t ticks_ = 0;
  std::uint32_t uptime_ms_ = 60'000;
};

}  // namespace rc10::test::myactuator_bench
