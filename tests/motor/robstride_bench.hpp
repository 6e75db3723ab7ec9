#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/socket_pair.hpp"
#include "drives/robstride/robstride_family.hpp"
#include "support/alloc_guard.hpp"
#include "support/robstride_settings.hpp"

namespace rc10::test::robstride_bench {

using std::chrono::milliseconds;
inline constexpr int kDrive = 127;
inline constexpr int kHost = 253;

inline std::uint32_t typeOf(const CanFrame& frame) { return frame.id.value >> 24U; }

/// One motor, and a drive that says what the test says.
class Bench {
 public:
  explicit Bench(const MotorSettings& settings)
      : motor(settings),
        codec{.model = findRobstrideModel(settings.model),
              .position_range_rad = findRobstrideModel(settings.model)->position_range_rad,
              .drive_id = settings.id,
              .host_id = kHost} {}

  std::vector<CanFrame> tick(FrameKind kind, const Target& target = {}) {
    motor.order(kind, target);
    return tick();
  }
  std::vector<CanFrame> tick() {
    now += milliseconds{1};
    const Tick at{.index = ++ticks, .now = now, .dt_s = 0.001F};
    motor.update(at);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor.packCommand(at, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  FrameVerdict say(robstride::Feedback state) {
    auto frame = codec.answer(state);
    frame.received = now;
    return motor.updateFeedback(frame);
  }
  FrameVerdict run(double position_rad = 0.0, double velocity_rad_s = 0.0) {
    return say({.position_rad = position_rad, .velocity_rad_s = velocity_rad_s, .mode = robstride::kRunning});
  }
  FrameVerdict runAfter(Duration pause, double position_rad, double velocity_rad_s = 0.0) {
    now += pause;
    return run(position_rad, velocity_rad_s);
  }
  FrameVerdict parameter(std::uint16_t index, std::uint32_t bits, bool known = true) {
    auto frame = codec.parameter(index, bits, known);
    frame.received = now;
    return motor.updateFeedback(frame);
  }
  SpringLaw operation(const Target& target) {
    for (const auto& frame : tick(FrameKind::kCommand, target)) {
      if (typeOf(frame) == 1) return codec.operation(frame);
    }
    ADD_FAILURE() << "no command of the operation mode";
    return {};
  }

  RobStride_Motor motor;
  robstride::Codec codec;
  MonotonicTime now{std::chrono::hours{1}};
  std::uint64_t ticks = 0;
};

inline MotorSettings controlled(std::string control, std::string_view model = "RS00") {
  auto settings = robStrideSettings(model);
  settings.own.set("control", std::move(control));
  return settings;
}

inline double torqueOf(const SpringLaw& told, double position_rad, double velocity_rad_s) {
  return told.stiffness_nm_per_rad * (told.position_rad - position_rad) +
         told.damping_nms_per_rad * (told.velocity_rad_s - velocity_rad_s) + told.torque_nm;
}

}  // namespace rc10::test::robstride_bench
