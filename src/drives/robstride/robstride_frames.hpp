#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "bus/can_frame.hpp"
#include "drives/robstride/robstride_model.hpp"
#include "motor/fault_code.hpp"
#include "motor/spring_law.hpp"

namespace rc10::robstride {

/// The private protocol of RobStride and CyberGear: extended ids, type (bits 28-24), data (23-8), addressee
/// (7-0). Source of all of it: the manuals named in robstride_model.cpp.
enum class Type : std::uint8_t {
  kGetId = 0,
  kOperate = 1,
  kFeedback = 2,
  kEnable = 3,
  kStop = 4,
  kSetZero = 6,
  kSetId = 7,
  kReadParameter = 17,
  kWriteParameter = 18,
  kFault = 21,
  kSave = 22,    ///< RobStride only: a CyberGear takes it for another bit rate.
  kReport = 24,  ///< Feedback that is sent unasked: type 24 in some manuals, type 2 in others.
};

/// Indices of parameters; those that are written live in RAM until the drive is told to save them.
namespace parameter {
inline constexpr std::uint16_t kRunMode = 0x7005;        ///< u8
inline constexpr std::uint16_t kCurrentRef = 0x7006;     ///< A
inline constexpr std::uint16_t kVelocityRef = 0x700A;    ///< rad/s
inline constexpr std::uint16_t kTorqueLimit = 0x700B;    ///< N·m
inline constexpr std::uint16_t kPositionRef = 0x7016;    ///< rad
inline constexpr std::uint16_t kVelocityLimit = 0x7017;  ///< rad/s, of position control
inline constexpr std::uint16_t kCurrentLimit = 0x7018;   ///< A, of velocity and position control
inline constexpr std::uint16_t kPosition = 0x7019;       ///< rad, counted over turns
inline constexpr std::uint16_t kSupplyVoltage = 0x701C;  ///< V
}  // namespace parameter

enum class RunMode : std::uint8_t { kOperation = 0, kVelocity = 2, kCurrent = 3 };

/// The CAN timeout counts 50 us: 20000 are 1 s.
inline constexpr std::uint32_t kTimeoutPerMs = 20;

[[nodiscard]] constexpr CanId canId(Type type, std::uint32_t data, int addressee) noexcept {
  return {static_cast<std::uint32_t>(type) << 24U | (data & 0xFFFFU) << 8U |
              (static_cast<std::uint32_t>(addressee) & 0xFFU),
          true};
}

struct Feedback {
  std::uint16_t raw_position = 0;
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double torque_nm = 0.0;
  double temperature_c = 0.0;
  std::uint8_t status_bits = 0;  ///< Bits 16-21 of the id: see faultOf().
  std::uint8_t mode = 0;         ///< 0 reset (no torque), 1 calibration, 2 running.
};
inline constexpr std::uint8_t kRunning = 2;

/// One direction and one addressee; the model's scales, but for the position's.
struct Codec {
  const RobstrideModel* model = nullptr;
  double position_range_rad = 0.0;
  int drive_id = 0;
  int host_id = 0;

  /// Beyond the ends of a scale: its end. NaN: 0.
  [[nodiscard]] CanFrame operate(const SpringLaw& wanted) const noexcept;
  [[nodiscard]] CanFrame enable() const noexcept;
  [[nodiscard]] CanFrame stop(bool clear_faults = false) const noexcept;
  [[nodiscard]] CanFrame read(std::uint16_t index) const noexcept;
  /// `bits`: a float's IEEE 754, or an integer.
  [[nodiscard]] CanFrame write(std::uint16_t index, std::uint32_t bits) const noexcept;
  [[nodiscard]] CanFrame write(std::uint16_t index, float value) const noexcept;

  /// One step of the field for the damping.
  [[nodiscard]] double dampingStep() const noexcept;

  /// Feedback in a frame of 8 bytes.
  [[nodiscard]] Feedback feedback(const CanFrame& frame) const noexcept;

  // For the simulated drive. `told`: all but raw_position is used.
  [[nodiscard]] SpringLaw operation(const CanFrame& frame) const noexcept;
  [[nodiscard]] CanFrame answer(const Feedback& told) const noexcept;
  [[nodiscard]] CanFrame parameter(std::uint16_t index, std::uint32_t bits, bool known) const noexcept;
  [[nodiscard]] CanFrame fault(std::uint32_t fault_word) const noexcept;
  /// The answer to kGetId. It goes to 0xFE, whoever asked.
  [[nodiscard]] CanFrame identity(const std::array<std::uint8_t, 8>& unique_id) const noexcept;
};

/// The drive's faults as one number: the word of a fault frame (bits 0-16), and above it from bit 24 on the
/// six status bits of the feedback's id.
[[nodiscard]] constexpr std::uint32_t nativeCode(std::uint32_t fault_word,
                                                 std::uint8_t status_bits) noexcept {
  return (fault_word & 0x00FF'FFFFU) | static_cast<std::uint32_t>(status_bits & 0x3FU) << 24U;
}

/// The gravest of the faults in such a number.
[[nodiscard]] FaultCode faultOf(std::uint32_t native_code, bool cyber_gear) noexcept;

}  // namespace rc10::robstride
