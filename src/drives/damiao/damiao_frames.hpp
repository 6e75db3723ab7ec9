#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "bus/can_frame.hpp"
#include "drives/damiao/damiao_model.hpp"
#include "motor/fault_code.hpp"
#include "motor/spring_law.hpp"

namespace rc10::damiao {

// The frames of a Damiao drive: DM-J manuals of 2026 (J4310 V1.2, J3507 V1.1), chapter "CAN Communication".
// Everything is at the drive's own output: rad, rad/s, Nm.

inline constexpr std::uint32_t kRegisterId = 0x7FF;
/// Bits of a received id by which a drive sees whether it is meant (manual, "Feedback
/// Mechanism"): it answers whatever frame has its id there.
inline constexpr std::uint32_t kAddressMask = 0x0FF;
/// The low nibble of byte 0 of feedback is the id; the other is the status. Ids above 15 spoil the status.
inline constexpr int kMaxId = 15;
inline constexpr double kKpMax = 500.0;
inline constexpr double kKdMax = 5.0;
inline constexpr double kKdStep = kKdMax / 4095.0;
/// One step of the register TIMEOUT.
inline constexpr double kTimeoutStepMs = 0.05;

enum class Register : std::uint8_t {
  kUnderVoltage = 0,
  kTorqueConstant = 1,  ///< N·m/A
  kOverTemperature = 2,
  kOverCurrent = 3,  ///< Share of the drive's maximum.
  kAcceleration = 4,
  kDeceleration = 5,  ///< Below 0.
  kMaxSpeed = 6,
  kMasterId = 7,
  kId = 8,
  kTimeout = 9,
  kControlMode = 10,
  kDamping = 11,
  kInertia = 12,
  kHardwareVersion = 13,
  kSoftwareVersion = 14,
  kSerialNumber = 15,
  kPolePairs = 16,
  kResistance = 17,
  kInductance = 18,
  kFlux = 19,
  kGear = 20,
  kPMax = 21,
  kVMax = 22,
  kTMax = 23,
  kOverVoltage = 29,
  kOutputPosition = 81,  ///< "xout", rad: goes on over turns, unlike the field in the feedback.
};

/// Byte 2 of a frame to or about a register.
inline constexpr std::uint8_t kReadOperation = 0x33;
inline constexpr std::uint8_t kWriteOperation = 0x55;
inline constexpr std::uint8_t kSaveOperation = 0xAA;
inline constexpr std::uint8_t kStateOperation = 0xCC;  ///< Asks for the state.

/// The status in feedback. Those from kFirstFault on are faults.
inline constexpr std::uint8_t kStatusDisabled = 0;
inline constexpr std::uint8_t kStatusEnabled = 1;
inline constexpr std::uint8_t kFirstFault = 2;

/// The last byte of a frame of seven FF.
enum class Special : std::uint8_t { kClear = 0xFB, kEnable = 0xFC, kDisable = 0xFD, kZero = 0xFE };

/// Feedback as it was sent, unscaled.
struct State {
  std::uint8_t status = 0;
  std::uint16_t position = 0;  ///< 0 to 65535: -p_max to p_max; beyond, the code wraps.
  std::uint16_t velocity = 0;  ///< 12 bits
  std::uint16_t torque = 0;    ///< 12 bits
  std::uint8_t drive_temperature = 0;
  std::uint8_t winding_temperature = 0;
};

/// The answer to a read or write of a register; not only of those above.
struct RegisterReply {
  std::uint8_t id = 0;
  bool written = false;
  Register address{};
  std::uint32_t value = 0;
};

using Payload = std::array<std::uint8_t, 8>;

/// Linear, from [-limit, limit] to [0, 2^bits - 1], towards the lower end as the vendor's code does. Values
/// outside, and NaN, end at a bound (NaN: the middle).
[[nodiscard]] std::uint16_t toCode(double value, double limit, unsigned bits) noexcept;
[[nodiscard]] double fromCode(double code, double limit, unsigned bits) noexcept;
/// Measurement behind a code: the middle of its step, since the drive rounds down. 0 comes out as 0.
[[nodiscard]] inline double measured(std::uint16_t code, double limit, unsigned bits) noexcept {
  return fromCode(code + 0.5, limit, bits);
}
/// rad for each step of the position.
[[nodiscard]] double positionStep(const DamiaoScale& scale) noexcept;
[[nodiscard]] double torqueStep(const DamiaoScale& scale) noexcept;

// 8 bytes each.
[[nodiscard]] Payload special(Special command) noexcept;
[[nodiscard]] Payload mit(const SpringLaw& command, const DamiaoScale& scale) noexcept;
[[nodiscard]] SpringLaw readMit(std::span<const std::uint8_t, 8> payload, const DamiaoScale& scale) noexcept;
[[nodiscard]] Payload positionVelocity(float position_rad, float limit_rad_s) noexcept;
/// `current_pu`: of the drive's maximum, 0 to 1.
[[nodiscard]] Payload forcePosition(float position_rad, double limit_rad_s, double current_pu) noexcept;
[[nodiscard]] Payload readRegister(int id, Register address) noexcept;
[[nodiscard]] Payload writeRegister(int id, Register address, std::uint32_t value) noexcept;
/// Stores all registers in flash; the drive has to be disabled. Byte 3 as the vendor's code has it.
[[nodiscard]] Payload saveRegisters(int id) noexcept;
/// 4 bytes: the vendor's manual and openarm; others pad to 8.
[[nodiscard]] std::array<std::uint8_t, 4> velocity(float rad_s) noexcept;

[[nodiscard]] State readState(std::span<const std::uint8_t, 8> payload) noexcept;
[[nodiscard]] Payload writeState(int id, const State& state) noexcept;
/// An answer about a register, to any sender's question; saving counts as register 0. Feedback of a
/// disabled drive can look like one at three of the 65536 positions, while it turns backwards at more than a
/// third of its range: such a sample is lost.
[[nodiscard]] std::optional<RegisterReply> readReply(std::span<const std::uint8_t, 8> payload,
                                                     int id) noexcept;

[[nodiscard]] std::uint32_t bitsOf(float value) noexcept;
[[nodiscard]] float floatOf(std::uint32_t bits) noexcept;

/// Value of a temperature byte: the drive casts a float to it, so cold comes as the two's complement.
[[nodiscard]] float temperature(std::uint8_t byte) noexcept;

/// Fault of a status; kNone below kFirstFault.
[[nodiscard]] FaultCode faultOf(std::uint8_t status) noexcept;

}  // namespace rc10::damiao
