#include "drives/odrive/odrive_wording.hpp"

#include <cstdint>

#include "bus/byte_order.hpp"
#include "drives/odrive/odrive_frames.hpp"

namespace rc10 {

std::string wordOdrive(const CanFrame& frame, std::string_view /*model*/, bool /*sent*/) {
  if (frame.id.extended || frame.fd) return {};
  const int node = static_cast<int>(frame.id.value >> odrive::kMessageBits);
  const auto message = odrive::messageOf(frame.id);
  const auto payload = frame.payload();
  const auto pair = [&](const char* what, const char* first, const char* first_unit, const char* second,
                        const char* second_unit) -> std::string {
    const auto values = odrive::decodePair(frame);
    if (!values) return FrameWords{node, what}.word("asked for").take();
    return FrameWords{node, what}
        .add(first, static_cast<double>(values->first), first_unit)
        .add(second, static_cast<double>(values->second), second_unit)
        .take();
  };
  switch (message) {
    case odrive::Message::kHeartbeat: {
      const auto beat = odrive::decodeHeartbeat(frame);
      if (!beat) return {};
      return FrameWords{node, "heartbeat"}
          .add("axis state", static_cast<double>(beat->state))
          .code("axis error", beat->axis_error)
          .take();
    }
    case odrive::Message::kEstop: return FrameWords{node, "e-stop"}.take();
    case odrive::Message::kReboot: return FrameWords{node, "reboot"}.take();
    case odrive::Message::kStartAnticogging: return FrameWords{node, "start anticogging"}.take();
    case odrive::Message::kSetPosition: return FrameWords{node, "set position"}.take();
    case odrive::Message::kSetTrajVelocity: return FrameWords{node, "set trajectory velocity"}.take();
    case odrive::Message::kSetTrajAcceleration: return FrameWords{node, "set trajectory acceleration"}.take();
    case odrive::Message::kSetTrajInertia: return FrameWords{node, "set trajectory inertia"}.take();
    case odrive::Message::kSetPositionGain: return FrameWords{node, "set position gain"}.take();
    case odrive::Message::kSetVelocityGains: return FrameWords{node, "set velocity gains"}.take();
    case odrive::Message::kEnterDfu: return FrameWords{node, "enter firmware update"}.take();
    // Other things in the two generations of firmware.
    case odrive::Message::kRxSdo:
    case odrive::Message::kSetNodeId: return {};
    case odrive::Message::kClearErrors: return FrameWords{node, "clear errors"}.take();
    case odrive::Message::kSetAxisState:
      if (payload.size() < 4) return {};
      return FrameWords{node, "set axis state"}.add({}, readLittleEndian<std::uint32_t>(payload, 0)).take();
    case odrive::Message::kSetControllerMode:
      if (payload.size() < 4) return {};
      return FrameWords{node, "set controller mode"}
          .add({}, readLittleEndian<std::uint32_t>(payload, 0))
          .take();
    case odrive::Message::kSetInputPos:
      if (payload.size() < 4) return {};
      return FrameWords{node, "command"}
          .add("position", static_cast<double>(readLittleEndian<float>(payload, 0)), "rev")
          .take();
    case odrive::Message::kSetInputVel:
      if (payload.size() < 4) return {};
      return FrameWords{node, "command"}
          .add("velocity", static_cast<double>(readLittleEndian<float>(payload, 0)), "rev/s")
          .take();
    case odrive::Message::kSetInputTorque:
      if (payload.size() < 4) return {};
      return FrameWords{node, "command"}
          .add("torque", static_cast<double>(readLittleEndian<float>(payload, 0)), "Nm")
          .take();
    case odrive::Message::kSetLimits: return pair("limits", "velocity", "rev/s", "current", "A");
    case odrive::Message::kEncoderEstimates: return pair("encoder", "position", "rev", "velocity", "rev/s");
    case odrive::Message::kIq: return pair("current", "wanted", "A", "measured", "A");
    case odrive::Message::kTemperature: return pair("temperature", "drive", "°C", "motor", "°C");
    case odrive::Message::kBusVoltage: return pair("supply", "voltage", "V", "current", "A");
    case odrive::Message::kTorques: return pair("torque", "wanted", "Nm", "measured", "Nm");
  }
  return {};
}

}  // namespace rc10
