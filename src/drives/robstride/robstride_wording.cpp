#include "drives/robstride/robstride_wording.hpp"

#include <cstdint>

#include "bus/byte_order.hpp"
#include "drives/robstride/robstride_frames.hpp"
#include "drives/robstride/robstride_model.hpp"

namespace rc10 {

std::string wordRobstride(const CanFrame& frame, std::string_view model, bool /*sent*/) {
  const auto* robstride_model = findRobstrideModel(model);
  if (robstride_model == nullptr || !frame.id.extended || frame.fd || frame.length != 8) return {};
  const int to = static_cast<int>(frame.id.value & 0xFFU);
  const int from = static_cast<int>(frame.id.value >> 8U & 0xFFU);
  const robstride::Codec codec{.model = robstride_model,
                               .position_range_rad = robstride_model->position_range_rad,
                               .drive_id = from,
                               .host_id = to};
  const auto parameter = [&](int id, const char* what) {
    return FrameWords{id, what}
        .code("parameter", readLittleEndian<std::uint16_t>(frame.payload(), 0))
        .code("value", readLittleEndian<std::uint32_t>(frame.payload(), 4))
        .take();
  };
  switch (static_cast<robstride::Type>(frame.id.value >> 24U)) {
    case robstride::Type::kGetId: return FrameWords{from == 0 ? to : from, "identity"}.take();
    case robstride::Type::kEnable: return FrameWords{to, "enable"}.take();
    case robstride::Type::kStop:
      return FrameWords{to, frame.data[0] == 1 ? "stop, clear faults" : "stop"}.take();
    case robstride::Type::kSetZero: return FrameWords{to, "set zero"}.take();
    case robstride::Type::kSetId: return FrameWords{to, "set id"}.take();
    case robstride::Type::kSave: return FrameWords{to, "save"}.take();
    // A question goes to the drive, its answer to the host: both have the drive's id where the sender's is.
    case robstride::Type::kReadParameter: return parameter(to, "parameter read");
    case robstride::Type::kWriteParameter: return parameter(to, "parameter written");
    case robstride::Type::kFault:
      return FrameWords{from, "faults"}
          .code("word", readLittleEndian<std::uint32_t>(frame.payload(), 0))
          .take();
    case robstride::Type::kOperate: {
      const auto told = codec.operation(frame);
      return FrameWords{to, "command"}
          .add("position", told.position_rad, "rad")
          .add("velocity", told.velocity_rad_s, "rad/s")
          .add("stiffness", told.stiffness_nm_per_rad, "Nm/rad")
          .add("damping", told.damping_nms_per_rad, "Nms/rad")
          .add("torque", told.torque_nm, "Nm")
          .add("scale of the position", codec.position_range_rad, "rad")
          .take();
    }
    case robstride::Type::kFeedback:
    case robstride::Type::kReport: {
      const auto seen = codec.feedback(frame);
      return FrameWords{from, seen.mode == robstride::kRunning ? "feedback, running" : "feedback, no torque"}
          .add("position", seen.position_rad, "rad")
          .add("velocity", seen.velocity_rad_s, "rad/s")
          .add("torque", seen.torque_nm, "Nm")
          .add("temperature", seen.temperature_c, "°C")
          .code("faults", seen.status_bits)
          .add("scale of the position", codec.position_range_rad, "rad")
          .take();
    }
  }
  return {};
}

}  // namespace rc10
