#include "drives/dji/dji_frames.hpp"

namespace rc10::dji {

CanFrame groupCommand(CanId id, const std::array<std::int16_t, kGroupSize>& raw) noexcept {
  std::array<std::uint8_t, kLength> data{};
  for (std::size_t slot = 0; slot < kGroupSize; ++slot) writeBigEndian(data, 2 * slot, raw[slot]);
  return makeClassicFrame(id, data);
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
