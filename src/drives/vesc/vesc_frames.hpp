#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "bus/can_frame.hpp"

namespace rc10::vesc {

// The frames of VESC drives. Extended id = packet << 8 | controller id, big-endian payloads, classic CAN.
// Source: vedderb/bldc@b9d287b:datatypes.h, comm/comm_can.c, comm/commands.c, also tags 5.03 to 7.00.

enum class Packet : std::uint8_t {
  kSetDuty = 0,
  kSetCurrent = 1,
  kSetCurrentBrake = 2,
  kSetErpm = 3,
  kSetPosition = 4,
  kProcessShortBuffer = 8,  ///< A question or command to the drive, and its answer.
  kStatus1 = 9,
  kSetCurrentRelative = 10,
  kSetCurrentBrakeRelative = 11,
  kSetHandbrake = 12,
  kSetHandbrakeRelative = 13,
  kStatus2 = 14,
  kStatus3 = 15,
  kStatus4 = 16,
  kPing = 17,
  kPong = 18,
  kDetect = 19,  ///< Turns the motor to measure it.
  kSetCurrentLimits = 21,
  kStoreCurrentLimits = 22,
  kSetInputCurrentLimits = 23,
  kStoreInputCurrentLimits = 24,
  kSetFocErpms = 25,
  kStoreFocErpms = 26,
  kStatus5 = 27,
  kSetBatteryCut = 29,
  kStoreBatteryCut = 30,
  kShutdown = 31,
  kSetPositionOffset = 55,  ///< Moves the place that its position loop holds.
  kNotifyBoot = 57,         ///< Sent once when the drive has started; since firmware 6.00.
  kStatus6 = 58,
};

/// Firmware takes frames to this id as meant for itself, whatever its own id.
inline constexpr int kBroadcast = 255;

[[nodiscard]] constexpr CanId canId(Packet packet, int controller_id) noexcept {
  return {static_cast<std::uint32_t>(packet) << 8U | (static_cast<std::uint32_t>(controller_id) & 0xFFU),
          true};
}

// Raw units per A, rpm (electrical), degree or 1.
inline constexpr double kPerAmpere = 1e3;
inline constexpr double kPerShare = 1e5;  ///< Duty, and currents relative to the drive's maximum.
inline constexpr double kPerErpm = 1.0;
inline constexpr double kPerDegree = 1e6;

/// The integer nearest to value * scale; beyond 32 bits the last one, and 0 for NaN.
[[nodiscard]] std::int32_t toRaw(double value, double scale) noexcept;

/// A command: always 4 bytes. Firmware >= 6.00 reads a SET_CURRENT of 6 bytes or more as a delay and then the
/// current, so that 1 A padded with zeros becomes the drive's full current.
[[nodiscard]] CanFrame makeCommand(Packet packet, int controller_id, std::int32_t raw) noexcept;

/// Commands that one drive passes on to another (COMM_FORWARD_CAN) in a frame kProcessShortBuffer:
/// COMM_JUMP_TO_BOOTLOADER, SET_DUTY, SET_CURRENT, SET_CURRENT_BRAKE, SET_RPM, SET_POS, SET_HANDBRAKE,
/// DETECT_MOTOR_R_L, DETECT_ENCODER, DETECT_HALL_FOC, REBOOT, SET_CURRENT_REL.
inline constexpr std::array<std::uint8_t, 12> kPassedCommands{1, 5, 6, 7, 8, 9, 10, 25, 27, 28, 29, 84};

// Questions that fit into one frame each way: COMM_GET_VALUES_SELECTIVE (50) with one bit
// of its mask. It moves nothing and feeds no watchdog.
inline constexpr std::uint32_t kAskFault = 1U << 15U;   ///< mc_fault_code
inline constexpr std::uint32_t kAskStatus = 1U << 21U;  ///< kTimedOut, kKillSwitch
inline constexpr std::uint8_t kTimedOut = 1U << 0U;     ///< Its watchdog: too long without a command.
inline constexpr std::uint8_t kKillSwitch = 1U << 1U;
[[nodiscard]] CanFrame makeQuestion(int controller_id, int host_id, std::uint32_t mask) noexcept;

struct Answer {
  std::uint32_t mask = 0;
  std::uint8_t value = 0;
};
/// Nothing if it is no answer to such a question.
[[nodiscard]] std::optional<Answer> decodeAnswer(const CanFrame& frame) noexcept;

// Status frames. 8 bytes, which the caller has checked.
inline constexpr std::size_t kStatusLength = 8;
/// Resolution of the reported motor current.
inline constexpr double kAmperesPerCount = 0.1;

struct Status1 {
  std::int32_t erpm = 0;
  float current_a = 0.0F;  ///< Positive when the motor takes power, negative when it gives power back.
  float duty = 0.0F;       ///< Duty cycle with the sign of the voltage.
};
struct Status2 {
  double charge_used_ah = 0.0;
  double charge_returned_ah = 0.0;
};
struct Status3 {
  double energy_used_wh = 0.0;
  double energy_returned_wh = 0.0;
};
struct Status4 {
  float drive_c = 0.0F;  ///< The transistors.
  float motor_c = 0.0F;  ///< Meaningless without a sensor.
  float input_a = 0.0F;
  float position_deg = 0.0F;  ///< Position of its position loop, [0, 360).
};
struct Status5 {
  std::int32_t steps = 0;  ///< 6 per electrical turn, counting on over turns.
  float input_v = 0.0F;
};
struct Status6 {
  float adc1_v = 0.0F;
  float adc2_v = 0.0F;
  float adc3_v = 0.0F;
  float ppm = 0.0F;
};
[[nodiscard]] Status1 decodeStatus1(const CanFrame& frame) noexcept;
[[nodiscard]] Status2 decodeStatus2(const CanFrame& frame) noexcept;
[[nodiscard]] Status3 decodeStatus3(const CanFrame& frame) noexcept;
[[nodiscard]] Status4 decodeStatus4(const CanFrame& frame) noexcept;
[[nodiscard]] Status5 decodeStatus5(const CanFrame& frame) noexcept;
[[nodiscard]] Status6 decodeStatus6(const CanFrame& frame) noexcept;

}  // namespace rc10::vesc
