#include "drives/myactuator/myactuator_wording.hpp"

#include <cstdint>
#include <span>

#include "bus/byte_order.hpp"
#include "drives/myactuator/myactuator_frames.hpp"

namespace rc10 {
namespace {

using MyactuatorCode = myactuator::Code;

std::string myactuatorRequest(int id, std::span<const std::uint8_t> payload) {
  const double value = readLittleEndian<std::int32_t>(payload, 4) * myactuator::kDegPerRaw;
  switch (myactuator::codeOf(payload)) {
    case MyactuatorCode::kReset: return FrameWords{id, "reset"}.take();
    case MyactuatorCode::kReleaseBrake: return FrameWords{id, "release the brake"}.take();
    case MyactuatorCode::kShutdown: return FrameWords{id, "off"}.take();
    case MyactuatorCode::kStop: return FrameWords{id, "stop"}.take();
    case MyactuatorCode::kAngle: return FrameWords{id, "asked for its angle"}.take();
    case MyactuatorCode::kStatus: return FrameWords{id, "asked for its status"}.take();
    case MyactuatorCode::kReading: return FrameWords{id, "asked for its reading"}.take();
    case MyactuatorCode::kUptime: return FrameWords{id, "asked for its uptime"}.take();
    case MyactuatorCode::kCurrent:
      return FrameWords{id, "command"}
          .add("current", readLittleEndian<std::int16_t>(payload, 4) * 0.01, "A")
          .take();
    case MyactuatorCode::kVelocity: return FrameWords{id, "command"}.add("velocity", value, "deg/s").take();
    case MyactuatorCode::kPosition:
      return FrameWords{id, "command"}
          .add("angle", value, "deg")
          .add("at most", readLittleEndian<std::uint16_t>(payload, 2), "deg/s")
          .take();
    default: return FrameWords{id, "request"}.code("code", payload[0]).take();
  }
}

std::string myactuatorReply(int id, std::span<const std::uint8_t> payload) {
  switch (myactuator::codeOf(payload)) {
    case MyactuatorCode::kReading:
    case MyactuatorCode::kCurrent:
    case MyactuatorCode::kVelocity:
    case MyactuatorCode::kPosition: {
      const auto reading = myactuator::decodeReading(payload);
      return FrameWords{id, "reading"}
          .add("angle", reading.angle_deg, "deg")
          .add("velocity", reading.velocity_deg_s, "deg/s")
          .add("current", reading.current_a, "A")
          .add("temperature", reading.temperature_c, "°C")
          .take();
    }
    case MyactuatorCode::kStatus: {
      const auto status = myactuator::decodeStatus(payload);
      return FrameWords{id, "status"}
          .add("voltage", status.voltage_v, "V")
          .add("temperature", status.temperature_c, "°C")
          .code("errors", status.errors)
          .take();
    }
    case MyactuatorCode::kAngle:
      return FrameWords{id, "angle"}
          .add({}, myactuator::decodeAngle(payload) * myactuator::kDegPerRaw, "deg")
          .take();
    case MyactuatorCode::kUptime:
      return FrameWords{id, "uptime"}.add({}, myactuator::decodeUptimeMs(payload), "ms").take();
    case MyactuatorCode::kShutdown: return FrameWords{id, "is off"}.take();
    case MyactuatorCode::kSilenceStopped: return FrameWords{id, "stopped by its watchdog"}.take();
    default: return FrameWords{id, "reply"}.code("code", payload[0]).take();
  }
}

}  // namespace

std::string wordMyactuator(const CanFrame& frame, std::string_view /*model*/, bool /*sent*/) {
  if (frame.id.extended || frame.fd || frame.length != myactuator::kLength) return {};
  const auto within = [&](std::uint32_t base) {
    const int id = static_cast<int>(frame.id.value) - static_cast<int>(base);
    return id >= 1 && id <= myactuator::kMaxId ? id : 0;
  };
  const auto payload = frame.payload();
  if (const int id = within(myactuator::kRequestBase); id != 0) return myactuatorRequest(id, payload);
  if (const int id = within(myactuator::kReplyBase); id != 0) return myactuatorReply(id, payload);
  if (const int id = within(myactuator::kMotionBase); id != 0) return FrameWords{id, "motion command"}.take();
  if (const int id = within(myactuator::kMotionReplyBase); id != 0) {
    const auto motion = myactuator::decodeMotion(payload);
    return FrameWords{id, "motion"}
        .add("angle", motion.angle_rad, "rad")
        .add("velocity", motion.velocity_rad_s, "rad/s")
        .add("torque", motion.torque_nm, "Nm")
        .take();
  }
  return {};
}

}  // namespace rc10
