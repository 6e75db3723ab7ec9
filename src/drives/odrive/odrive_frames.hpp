#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bus/can_frame.hpp"

namespace rc10::odrive {

/// CANSimple: the low five bits of the id. Messages of both generations of firmware.
enum class Message : std::uint8_t {
  kHeartbeat = 0x01,
  kEstop = 0x02,
  kRxSdo = 0x04,      ///< Firmware 0.6: byte 0 is the operation; 0.5 sends its encoder error here.
  kSetNodeId = 0x06,  ///< Firmware 0.5; 0.6 tells its address here.
  kSetAxisState = 0x07,
  kEncoderEstimates = 0x09,
  kSetControllerMode = 0x0B,
  kSetInputPos = 0x0C,
  kSetInputVel = 0x0D,
  kSetInputTorque = 0x0E,
  kSetLimits = 0x0F,
  kStartAnticogging = 0x10,  ///< Firmware 0.5.
  kSetTrajVelocity = 0x11,
  kSetTrajAcceleration = 0x12,
  kSetTrajInertia = 0x13,
  kIq = 0x14,
  kTemperature = 0x15,  ///< Firmware 0.6; 0.5 sends its sensorless estimates here.
  kReboot = 0x16,
  kBusVoltage = 0x17,
  kClearErrors = 0x18,
  kSetPosition = 0x19,  ///< Renames the present position, and a position loop goes there.
  kSetPositionGain = 0x1A,
  kSetVelocityGains = 0x1B,
  kTorques = 0x1C,   ///< Firmware 0.6; 0.5 answers here with the voltage of a pin.
  kEnterDfu = 0x1F,  ///< Firmware 0.6.
};
inline constexpr std::uint8_t kSdoWrite = 1;
inline constexpr std::uint32_t kMessageBits = 5;
inline constexpr std::uint32_t kNodeMask = 0x7E0;

enum class AxisState : std::uint8_t { kUndefined = 0, kIdle = 1, kClosedLoop = 8 };
enum class ControlMode : std::int32_t { kTorque = 1, kVelocity = 2, kPosition = 3 };

[[nodiscard]] constexpr CanId canId(int node, Message message) noexcept {
  return {(static_cast<std::uint32_t>(node) << kMessageBits) | static_cast<std::uint32_t>(message), false};
}
[[nodiscard]] constexpr Message messageOf(CanId id) noexcept {
  return static_cast<Message>(id.value & ((1U << kMessageBits) - 1U));
}

// To the drive. Turns, turns per second and N·m of the encoder's shaft.

[[nodiscard]] CanFrame setAxisState(int node, AxisState state) noexcept;
/// With the input taken as it comes (passthrough): rc10d shapes targets itself.
[[nodiscard]] CanFrame setControllerMode(int node, ControlMode mode) noexcept;
/// The feed-forwards have a resolution of 0.001 and saturate at 32.767.
[[nodiscard]] CanFrame setInputPos(int node, float turns, float velocity_ff, float torque_ff) noexcept;
[[nodiscard]] CanFrame setInputVel(int node, float turns_per_s, float torque_ff) noexcept;
[[nodiscard]] CanFrame setInputTorque(int node, float torque) noexcept;
/// Acts in the drive's RAM: nothing is saved.
[[nodiscard]] CanFrame setLimits(int node, float turns_per_s, float current_a) noexcept;
[[nodiscard]] CanFrame clearErrors(int node) noexcept;

// From the drive. Empty: not 8 bytes of data, or a number that is none.

struct Heartbeat {
  std::uint32_t axis_error = 0;
  AxisState state = AxisState::kUndefined;
  /// Bytes 5 to 7. Firmware 0.5: bit 0 of them is an error of motor, encoder, controller. 0.6: the result
  /// of the last procedure, and whether the trajectory is done.
  std::uint8_t byte5 = 0;
  std::uint8_t byte6 = 0;
  std::uint8_t byte7 = 0;
};
[[nodiscard]] std::optional<Heartbeat> decodeHeartbeat(const CanFrame& frame) noexcept;

/// All other messages that matter here are two numbers.
struct Pair {
  float first = 0.0F;
  float second = 0.0F;
};
/// Any bits, also NaN.
[[nodiscard]] std::optional<Pair> decodePair(const CanFrame& frame) noexcept;

}  // namespace rc10::odrive
