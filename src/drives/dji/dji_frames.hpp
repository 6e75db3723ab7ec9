#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/byte_order.hpp"
#include "bus/can_frame.hpp"

/// The frames of C620, C610 and GM6020: standard ids, classic, 8 bytes, big endian. Up to four drives share a
/// command frame; each has a feedback frame of its own. Ids and scales are those of the model.
namespace rc10::dji {

inline constexpr std::size_t kLength = 8;  ///< Same for commands and feedback.
inline constexpr std::size_t kGroupSize = 4;
inline constexpr int kCountsPerTurn = 8192;  ///< Encoder: 0 to 8191.

/// Currents or voltages of the drives that listen to this id, by their slots. Written in place: bytes
/// behind the payload, and stamps, stay.
void writeGroupCommand(CanId id, const std::array<std::int16_t, kGroupSize>& raw, CanFrame& out) noexcept;

struct Feedback {
  std::uint16_t encoder = 0;
  std::int16_t rotor_rpm = 0;
  std::int16_t current_raw = 0;
  std::uint8_t temperature_c = 0;  ///< 0 from a C610, which has none.
};
[[nodiscard]] CanFrame feedbackFrame(CanId id, const Feedback& feedback) noexcept;

// The payload has 8 bytes.
[[nodiscard]] inline Feedback decodeFeedback(std::span<const std::uint8_t> payload) noexcept {
  return {.encoder = readBigEndian<std::uint16_t>(payload, 0),
          .rotor_rpm = readBigEndian<std::int16_t>(payload, 2),
          .current_raw = readBigEndian<std::int16_t>(payload, 4),
          .temperature_c = payload[6]};
}
[[nodiscard]] inline std::int16_t decodeCommand(std::span<const std::uint8_t> payload,
                                                std::size_t slot) noexcept {
  return readBigEndian<std::int16_t>(payload, 2 * slot);
}

}  // namespace rc10::dji
