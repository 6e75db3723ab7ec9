#include "drives/vesc/vesc_wording.hpp"

#include <cstdint>

#include "bus/byte_order.hpp"
#include "drives/vesc/vesc_frames.hpp"

namespace rc10 {
namespace {

using vesc::Packet;

std::string vescStatus(Packet packet, int id, const CanFrame& frame) {
  const auto f = [](float value) { return static_cast<double>(value); };
  switch (packet) {
    case Packet::kStatus1: {
      const auto status = vesc::decodeStatus1(frame);
      return FrameWords{id, "status 1"}
          .add("velocity", status.erpm, "erpm")
          .add("current", f(status.current_a), "A")
          .add("duty", f(status.duty))
          .take();
    }
    case Packet::kStatus2: {
      const auto status = vesc::decodeStatus2(frame);
      return FrameWords{id, "status 2"}
          .add("used", status.charge_used_ah, "Ah")
          .add("returned", status.charge_returned_ah, "Ah")
          .take();
    }
    case Packet::kStatus3: {
      const auto status = vesc::decodeStatus3(frame);
      return FrameWords{id, "status 3"}
          .add("used", status.energy_used_wh, "Wh")
          .add("returned", status.energy_returned_wh, "Wh")
          .take();
    }
    case Packet::kStatus4: {
      const auto status = vesc::decodeStatus4(frame);
      return FrameWords{id, "status 4"}
          .add("drive", f(status.drive_c), "°C")
          .add("motor", f(status.motor_c), "°C")
          .add("supply", f(status.input_a), "A")
          .add("position", f(status.position_deg), "deg")
          .take();
    }
    case Packet::kStatus5: {
      const auto status = vesc::decodeStatus5(frame);
      return FrameWords{id, "status 5"}
          .add("steps", status.steps)
          .add("supply", f(status.input_v), "V")
          .take();
    }
    case Packet::kStatus6: {
      const auto status = vesc::decodeStatus6(frame);
      return FrameWords{id, "status 6"}
          .add("adc 1", f(status.adc1_v), "V")
          .add("adc 2", f(status.adc2_v), "V")
          .add("adc 3", f(status.adc3_v), "V")
          .add("ppm", f(status.ppm))
          .take();
    }
    default: return {};
  }
}

std::string vescCommand(Packet packet, int id, const CanFrame& frame) {
  const auto command = [&](const char* name, double per_unit, const char* unit) -> std::string {
    if (frame.length < 4) return {};
    return FrameWords{id, "command"}
        .add(name, readBigEndian<std::int32_t>(frame.payload(), 0) / per_unit, unit)
        .take();
  };
  switch (packet) {
    case Packet::kSetDuty: return command("duty", vesc::kPerShare, "");
    case Packet::kSetCurrent: return command("current", vesc::kPerAmpere, "A");
    case Packet::kSetCurrentBrake: return command("brake current", vesc::kPerAmpere, "A");
    case Packet::kSetErpm: return command("velocity", vesc::kPerErpm, "erpm");
    case Packet::kSetPosition: return command("position", vesc::kPerDegree, "deg");
    case Packet::kSetCurrentRelative: return command("current", vesc::kPerShare, "of its most");
    case Packet::kSetCurrentBrakeRelative: return command("brake current", vesc::kPerShare, "of its most");
    case Packet::kSetHandbrake: return command("handbrake", vesc::kPerAmpere, "A");
    case Packet::kSetHandbrakeRelative: return command("handbrake", vesc::kPerShare, "of its most");
    case Packet::kPing: return FrameWords{id, "ping"}.take();
    case Packet::kPong: return FrameWords{id, "pong"}.take();
    case Packet::kProcessShortBuffer: return FrameWords{id, "question, command or answer"}.take();
    case Packet::kNotifyBoot: return FrameWords{id, "has started"}.take();
    default: return {};
  }
}

}  // namespace

std::string wordVesc(const CanFrame& frame, std::string_view /*model*/, bool /*sent*/) {
  if (!frame.id.extended || frame.fd || frame.id.value > 0xFFFF) return {};
  const auto packet = static_cast<vesc::Packet>(frame.id.value >> 8U);
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  auto words = frame.length == vesc::kStatusLength ? vescStatus(packet, id, frame) : std::string{};
  return words.empty() ? vescCommand(packet, id, frame) : words;
}

}  // namespace rc10
