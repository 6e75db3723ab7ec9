#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "bus/can_frame.hpp"
#include "drives/dji/dji_motor.hpp"

namespace rc10::test {

/// Report of a DJI drive, in its own units.
struct DjiReport {
  std::uint16_t position = 0;
  std::int16_t rpm = 0;
  std::int16_t current = 0;
  std::uint8_t temperature_c = 25;
};

inline CanFrame makeDjiFeedback(const DjiModel& model, int id, const DjiReport& report,
                                MonotonicTime received = {}) {
  CanFrame frame;
  frame.id = {model.feedback_id_base + static_cast<std::uint32_t>(id), false};
  frame.length = 8;
  frame.received = received;
  const auto put = [&frame](std::size_t at, std::uint16_t value) {
    frame.data[at] = static_cast<std::uint8_t>(value >> 8U);
    frame.data[at + 1] = static_cast<std::uint8_t>(value & 0xFFU);
  };
  put(0, report.position);
  put(2, static_cast<std::uint16_t>(report.rpm));
  put(4, static_cast<std::uint16_t>(report.current));
  frame.data[6] = report.temperature_c;
  return frame;
}

/// Values of the family's own key.
inline OwnValues djiOwn(DjiCommand command) {
  OwnValues own;
  own.set("command", std::string{command == DjiCommand::kVoltage ? "voltage" : "current"});
  return own;
}

/// Settings that pass DJI_Motor::check().
inline MotorSettings djiConfig(const DjiModel& model, int id = 1, DjiCommand command = DjiCommand::kCurrent) {
  MotorSettings config;
  config.name = std::string{model.name} + "_" + std::to_string(id);
  config.model = model.name;
  config.id = id;
  config.own = djiOwn(command);
  config.loops = model.command(command).default_loops;
  return config;
}

/// Gives a motor samples a millisecond apart.
class DjiFeeder {
 public:
  explicit DjiFeeder(DJI_Motor& motor) : motor_(motor) {}

  FrameVerdict feed(const DjiReport& report, Duration spacing = std::chrono::milliseconds{1}) {
    now_ += spacing;
    return motor_.updateFeedback(makeDjiFeedback(motor_.model(), motor_.driveId(), report, now_));
  }
  void tick() { motor_.update(Tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F}); }
  void feedAndTick(const DjiReport& report) {
    (void)feed(report);
    tick();
  }

 private:
  DJI_Motor& motor_;
  MonotonicTime now_{std::chrono::seconds{10}};
  std::uint64_t ticks_ = 0;
};

}  // namespace rc10::test
