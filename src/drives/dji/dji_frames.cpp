#include "drives/dji/dji_frames.hpp"

namespace rc10::dji {

void writeGroupCommand(CanId id, const std::array<std::int16_t, kGroupSize>& raw, CanFrame& out) noexcept {
  out.id = id;
  out.type = FrameType::kData;
  out.fd = false;
  out.bit_rate_switch = false;
  out.length = kLength;
  for (std::size_t slot = 0; slot < kGroupSize; ++slot) writeBigEndian(out.data, 2 * slot, raw[slot]);
}

CanFrame feedbackFrame(CanId id, const Feedback& feedback) noexcept {
  std::array<std::uint8_t, kLength> data{};
  writeBigEndian(data, 0, feedback.encoder);
  writeBigEndian(data, 2, feedback.rotor_rpm);
  writeBigEndian(data, 4, feedback.current_raw);
  data[6] = feedback.temperature_c;
  return makeClassicFrame(id, data);
}

}  // namespace rc10::dji
