#include "drives/lktech/lktech_wording.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/byte_order.hpp"
#include "drives/lktech/lktech_frames.hpp"

namespace rc10 {
namespace {

using lktech::Code;

std::string lktechCommand(int id, std::span<const std::uint8_t> payload) {
  const double angle = readLittleEndian<std::int32_t>(payload, 4) * lktech::kDegPerRaw;
  switch (lktech::codeOf(payload)) {
    case Code::kOff: return FrameWords{id, "off"}.take();
    case Code::kStop: return FrameWords{id, "stop"}.take();
    case Code::kOn: return FrameWords{id, "on"}.take();
    case Code::kAngle: return FrameWords{id, "asked for its angle"}.take();
    case Code::kStatus: return FrameWords{id, "asked for its status"}.take();
    case Code::kClear: return FrameWords{id, "clear errors"}.take();
    case Code::kReading: return FrameWords{id, "asked for its reading"}.take();
    case Code::kCurrent:
      return FrameWords{id, "command"}.add("current, raw", readLittleEndian<std::int16_t>(payload, 4)).take();
    case Code::kVelocity: return FrameWords{id, "command"}.add("rotor", angle, "deg/s").take();
    case Code::kPosition:
      return FrameWords{id, "command"}
          .add("rotor", angle, "deg")
          .add("at most", readLittleEndian<std::uint16_t>(payload, 2), "deg/s")
          .take();
  }
  return FrameWords{id, "command"}.code("code", payload[0]).take();
}

std::string lktechReply(int id, std::span<const std::uint8_t> payload) {
  switch (lktech::codeOf(payload)) {
    case Code::kReading:
    case Code::kCurrent:
    case Code::kVelocity:
    case Code::kPosition: {
      const auto reading = lktech::decodeReading(payload);
      return FrameWords{id, "reading"}
          .add("encoder, raw", reading.encoder)
          .add("rotor", reading.rotor_deg_s, "deg/s")
          .add("current, raw", reading.current_raw)
          .add("temperature", reading.temperature_c, "°C")
          .take();
    }
    case Code::kStatus:
    case Code::kClear: {
      const auto status = lktech::decodeStatus(payload);
      return FrameWords{id, status.off ? "status, off" : "status, on"}
          .add("voltage", status.voltage_v, "V")
          .add("temperature", status.temperature_c, "°C")
          .code("errors", status.errors)
          .take();
    }
    case Code::kAngle:
      return FrameWords{id, "angle"}
          .add("rotor", static_cast<double>(lktech::decodeAngle(payload)) * lktech::kDegPerRaw, "deg")
          .take();
    default: return FrameWords{id, "reply"}.code("code", payload[0]).take();
  }
}

}  // namespace

// Commands and replies have the same ids and codes.
std::string wordLktech(const CanFrame& frame, std::string_view /*model*/, bool sent) {
  if (frame.id.extended || frame.fd || frame.length != lktech::kLength) return {};
  const auto payload = frame.payload();
  if (frame.id.value == lktech::kGroupId && sent) {
    FrameWords words{"currents of 1 to 4, raw"};
    for (std::size_t slot = 0; slot < lktech::kGroupSize; ++slot)
      words.add({}, readLittleEndian<std::int16_t>(payload, 2 * slot));
    return words.take();
  }
  const int id = static_cast<int>(frame.id.value) - static_cast<int>(lktech::kBaseId);
  if (id < 1 || id > lktech::kMaxId) return {};
  return sent ? lktechCommand(id, payload) : lktechReply(id, payload);
}

}  // namespace rc10
