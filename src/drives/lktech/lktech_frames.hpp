#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "bus/can_frame.hpp"

/// The frames of LK-Tech's drives, protocol V2.35: standard ids, classic, 8 bytes, little endian. A drive
/// answers under the id of the command. Angles and speeds of commands and the speeds of replies
/// are those of the rotor, the encoder is that of the output.
namespace rc10::lktech {

inline constexpr std::uint32_t kBaseId = 0x140;
inline constexpr std::uint32_t kGroupId = 0x280;  ///< Currents of the ids 1 to 4.
inline constexpr int kMaxId = 32;
inline constexpr int kGroupSize = 4;
inline constexpr std::uint8_t kLength = 8;
inline constexpr double kDegPerRaw = 0.01;
inline constexpr int kRawCurrentMax = 2048;
inline constexpr int kRawGroupCurrentMax = 2000;

/// The first byte of a command and of its reply. Nothing here writes to the drive's memory.
enum class Code : std::uint8_t {
  kOff = 0x80,     ///< Also forgets the turns: rc10d never sends it.
  kStop = 0x81,    ///< Without torque, but still on: it keeps its turns.
  kOn = 0x88,      ///< As after power-up.
  kAngle = 0x92,   ///< Multi-turn.
  kStatus = 0x9A,  ///< Temperature, voltage, on or off, errors.
  kClear = 0x9B,   ///< Clears errors whose cause is gone. Replies as kStatus does.
  kReading = 0x9C,
  kCurrent = 0xA1,  ///< The reply to this and the next two is that of kReading.
  kVelocity = 0xA2,
  kPosition = 0xA4,
};

[[nodiscard]] CanFrame request(int id, Code code) noexcept;
[[nodiscard]] CanFrame currentCommand(int id, int raw) noexcept;
/// `limit_raw`: a bound of the current. Some firmware ignores it (RMCS calls them A and B).
[[nodiscard]] CanFrame velocityCommand(int id, double rotor_deg_s, int limit_raw) noexcept;
/// `limit_deg_s` is never sent as 0.
[[nodiscard]] CanFrame positionCommand(int id, double rotor_deg, double limit_deg_s) noexcept;
[[nodiscard]] CanFrame groupCommand(const std::array<int, kGroupSize>& raw) noexcept;

// Replies. The payload has 8 bytes.
[[nodiscard]] inline Code codeOf(std::span<const std::uint8_t> payload) noexcept {
  return static_cast<Code>(payload[0]);
}
/// Could these bytes be a command on their way to the drive? They share the id with its replies. A command
/// has a zero where a reply has the temperature.
[[nodiscard]] bool looksLikeCommand(std::span<const std::uint8_t> payload) noexcept;

struct Reading {
  int temperature_c = 0;
  int current_raw = 0;
  int rotor_deg_s = 0;
  std::uint16_t encoder = 0;
};
[[nodiscard]] Reading decodeReading(std::span<const std::uint8_t> payload) noexcept;

struct Status {
  int temperature_c = 0;
  double voltage_v = 0.0;
  bool off = false;
  std::uint8_t errors = 0;
};
[[nodiscard]] Status decodeStatus(std::span<const std::uint8_t> payload) noexcept;

/// In 0.01 degrees of the rotor. The document has 7 bytes, but firmware is known that fills only 4.
[[nodiscard]] std::int64_t decodeAngle(std::span<const std::uint8_t> payload) noexcept;

}  // namespace rc10::lktech
