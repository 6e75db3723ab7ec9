#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bus/can_frame.hpp"

namespace rc10 {

/// CANSimple: the low five bits of the id. What the two generations of firmware share.
enum class OdriveMessage : std::uint8_t {
  kHeartbeat = 0x01,
  kEstop = 0x02,
  kSetAxisState = 0x07,
  kEncoderEstimates = 0x09,
  kSetControllerMode = 0x0B,
  kSetInputPos = 0x0C,
  kSetInputVel = 0x0D,
  kSetInputTorque = 0x0E,
  kSetLimits = 0x0F,
  kIq = 0x14,
  kTemperature = 0x15,  ///< Firmware 0.6; 0.5 sends its sensorless estimates here.
  kReboot = 0x16,
  kBusVoltage = 0x17,
  kClearErrors = 0x18,
  kTorques = 0x1C,  ///< Firmware 0.6; 0.5 answers here with the voltage of a pin.
};
inline constexpr std::uint32_t kOdriveMessageBits = 5;
inline constexpr std::uint32_t kOdriveNodeMask = 0x7E0;

enum class OdriveAxisState : std::uint8_t { kUndefined = 0, kIdle = 1, kClosedLoop = 8 };
enum class OdriveControlMode : std::int32_t { kTorque = 1, kVelocity = 2, kPosition = 3 };

[[nodiscard]] constexpr CanId odriveId(int node, OdriveMessage message) noexcept {
  return {(static_cast<std::uint32_t>(node) << kOdriveMessageBits) | static_cast<std::uint32_t>(message),
          false};
}
[[nodiscard]] constexpr OdriveMessage odriveMessage(CanId id) noexcept {
  return static_cast<OdriveMessage>(id.value & ((1U << kOdriveMessageBits) - 1U));
}

// To the drive. Turns, turns per second and N·m of the encoder's shaft.

[[nodiscard]] CanFrame odriveSetAxisState(int node, OdriveAxisState state) noexcept;
/// With the input taken as it comes (passthrough): rc10d shapes targets itself.
[[nodiscard]] CanFrame odriveSetControllerMode(int node, OdriveControlMode mode) noexcept;
/// The feed-forwards have a resolution of 0.001 and saturate at 32.767.
[[nodiscard]] CanFrame odriveSetInputPos(int node, float turns, float velocity_ff, float torque_ff) noexcept;
[[nodiscard]] CanFrame odriveSetInputVel(int node, float turns_per_s, float torque_ff) noexcept;
[[nodiscard]] CanFrame odriveSetInputTorque(int node, float torque) noexcept;
/// Acts in the drive's RAM: nothing is saved.
[[nodiscard]] CanFrame odriveSetLimits(int node, float turns_per_s, float current_a) noexcept;
[[nodiscard]] CanFrame odriveClearErrors(int node) noexcept;

// From the drive. Empty: not 8 bytes of data, or a number that is none.

struct OdriveHeartbeat {
  std::uint32_t axis_error = 0;
  OdriveAxisState state = OdriveAxisState::kUndefined;
  /// Bytes 5 to 7. Firmware 0.5: bit 0 of them is an error of motor, encoder, controller. 0.6: the result
  /// of the last procedure, and whether the trajectory is done.
  std::uint8_t byte5 = 0;
  std::uint8_t byte6 = 0;
  std::uint8_t byte7 = 0;
};
[[nodiscard]] std::optional<OdriveHeartbeat> decodeOdriveHeartbeat(const CanFrame& frame) noexcept;

/// All other messages that matter here are two numbers.
struct OdrivePair {
  float first = 0.0F;
  float second = 0.0F;
};
/// Any bits, also NaN.
[[nodiscard]] std::optional<OdrivePair> decodeOdrivePair(const CanFrame& frame) noexcept;

}  // namespace rc10
