#include "drives/damiao/damiao_wording.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

#include "bus/byte_order.hpp"
#include "drives/damiao/damiao_frames.hpp"
#include "drives/damiao/damiao_model.hpp"

namespace rc10 {
namespace {

std::string damiaoCommand(const CanFrame& frame, const DamiaoScale& scale) {
  const auto payload = frame.payload();
  if (frame.id.value == damiao::kRegisterId) {
    if (payload.size() < 4) return {};
    return FrameWords{payload[0] | payload[1] << 8,
                      payload[2] == 0x33 ? "reads a register" : "writes a register"}
        .add("number", payload[3])
        .take();
  }
  const int id = static_cast<int>(frame.id.value & damiao::kAddressMask);
  const auto mode = static_cast<DamiaoControl>((frame.id.value >> 8U) + 1U);
  if (id < 1 || id > damiao::kMaxId || frame.id.value > 0x3FF) return {};
  if (mode == DamiaoControl::kVelocity)
    return FrameWords{id, "command"}
        .add("velocity", static_cast<double>(readLittleEndian<float>(payload, 0)), "rad/s")
        .take();
  if (payload.size() != 8) return {};
  if (std::all_of(payload.begin(), payload.end() - 1, [](std::uint8_t byte) { return byte == 0xFF; })) {
    switch (static_cast<damiao::Special>(payload[7])) {
      case damiao::Special::kClear: return FrameWords{id, "clear errors"}.take();
      case damiao::Special::kEnable: return FrameWords{id, "enable"}.take();
      case damiao::Special::kDisable: return FrameWords{id, "disable"}.take();
      case damiao::Special::kZero: return FrameWords{id, "set zero"}.take();
    }
  }
  if (mode == DamiaoControl::kPositionVelocity)
    return FrameWords{id, "command"}
        .add("position", static_cast<double>(readLittleEndian<float>(payload, 0)), "rad")
        .add("at most", static_cast<double>(readLittleEndian<float>(payload, 4)), "rad/s")
        .take();
  if (mode == DamiaoControl::kForcePosition)
    return FrameWords{id, "command"}
        .add("position", static_cast<double>(readLittleEndian<float>(payload, 0)), "rad")
        .take();
  const auto mit = damiao::readMit(payload.first<8>(), scale);
  return FrameWords{id, "MIT command"}
      .add("position", mit.position_rad, "rad")
      .add("velocity", mit.velocity_rad_s, "rad/s")
      .add("kp", mit.stiffness_nm_per_rad)
      .add("kd", mit.damping_nms_per_rad)
      .add("torque", mit.torque_nm, "Nm")
      .add("scale of the position", scale.p_max_rad, "rad")
      .take();
}

// Its master id may be any: the first byte has the drive's own id.
std::string damiaoFeedback(const CanFrame& frame, const DamiaoScale& scale) {
  if (frame.length != 8) return {};
  const auto payload = frame.payload().first<8>();
  const int id = payload[0] & 0x0F;
  if (id == 0) return {};
  if (const auto reply = damiao::readReply(payload, id); reply && reply->id == id)
    return FrameWords{id, "register"}
        .add("number", static_cast<double>(reply->address))
        .code("value", reply->value)
        .take();
  const auto state = damiao::readState(payload);
  FrameWords words{id, state.status == damiao::kStatusEnabled    ? "feedback, enabled"
                       : state.status == damiao::kStatusDisabled ? "feedback, disabled"
                                                                 : "feedback, fault"};
  if (state.status >= damiao::kFirstFault) words.code("status", state.status);
  return words.add("position", damiao::measured(state.position, scale.p_max_rad, 16), "rad")
      .add("velocity", damiao::measured(state.velocity, scale.v_max_rad_s, 12), "rad/s")
      .add("torque", damiao::measured(state.torque, scale.t_max_nm, 12), "Nm")
      .add("drive", static_cast<double>(damiao::temperature(state.drive_temperature)), "°C")
      .add("winding", static_cast<double>(damiao::temperature(state.winding_temperature)), "°C")
      .add("scale of the position", scale.p_max_rad, "rad")
      .take();
}

}  // namespace

std::string wordDamiao(const CanFrame& frame, std::string_view model, bool sent) {
  const auto* damiao_model = findDamiaoModel(model);
  if (damiao_model == nullptr || frame.id.extended || (frame.length != 8 && frame.length != 4)) return {};
  return sent ? damiaoCommand(frame, damiao_model->scale) : damiaoFeedback(frame, damiao_model->scale);
}

}  // namespace rc10
