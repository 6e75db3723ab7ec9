#pragma once

#include <cstdint>
#include <span>

#include "bus/can_frame.hpp"
#include "motor/spring_law.hpp"

/// The frames of MyActuator's drives, protocol V3 to V4.2: standard ids, classic, 8 bytes, little endian; the
/// motion mode alone is packed big endian. Angles and speeds are those of the drive's output.
namespace rc10::myactuator {

inline constexpr std::uint32_t kRequestBase = 0x140;
inline constexpr std::uint32_t kReplyBase = 0x240;
inline constexpr std::uint32_t kMotionBase = 0x400;
inline constexpr std::uint32_t kMotionReplyBase = 0x500;
inline constexpr std::uint32_t kBroadcastId = 0x280;  ///< Any request, to all drives.
inline constexpr std::uint32_t kIdSettingId = 0x300;
inline constexpr int kMaxId = 32;
inline constexpr std::uint8_t kLength = 8;
inline constexpr double kAmperesPerRaw = 0.01;
inline constexpr double kDegPerRaw = 0.01;

/// The first byte of a request and of its reply.
enum class Code : std::uint8_t {
  kFunction = 0x20,  ///< Settings, some of which are stored at once.
  kReadAcceleration = 0x42,
  kSetAcceleration = 0x43,  ///< Stored at once.
  kReset = 0x76,            ///< No reply.
  kReleaseBrake = 0x77,
  kShutdown = 0x80,  ///< Output off, no loop runs. The reply is a copy.
  kStop = 0x81,      ///< Stands still, with torque. The reply is a copy.
  kAngle = 0x92,     ///< Multi-turn.
  kStatus = 0x9A,    ///< Temperature, voltage, errors.
  kReading = 0x9C,   ///< The reply of the three commands below, without commanding anything.
  kCurrent = 0xA1,
  kVelocity = 0xA2,
  kPosition = 0xA4,
  kUptime = 0xB1,
  kSilenceLimit = 0xB3,  ///< Stored at once. ms; 0: none.
  /// Sent by a drive whose protection against silence (0xB3) has stopped it, once a second; the first request
  /// after that is sent back as it was and does nothing. Measured by ioio2995, 2b-t/myactuator_rmd_ros#4.
  kSilenceStopped = 0xF1,
};

/// A request that has no parameters.
[[nodiscard]] CanFrame request(int id, Code code) noexcept;
[[nodiscard]] CanFrame currentCommand(int id, double current_a) noexcept;
[[nodiscard]] CanFrame velocityCommand(int id, double velocity_deg_s) noexcept;
/// `limit_deg_s` is never sent as 0, which would mean no limit.
[[nodiscard]] CanFrame positionCommand(int id, double angle_deg, double limit_deg_s) noexcept;

// V4.2, 5.1: one set of ranges for all models.
inline constexpr double kMotionAngleRad = 12.5;
inline constexpr double kMotionVelocityRadS = 45.0;
inline constexpr double kMotionTorqueNm = 24.0;
inline constexpr double kMotionStiffness = 500.0;
inline constexpr double kMotionDamping = 5.0;

/// Values out of range are clamped.
[[nodiscard]] CanFrame motionCommand(int id, const SpringLaw& motion) noexcept;

// Replies. The payload has 8 bytes.
[[nodiscard]] inline Code codeOf(std::span<const std::uint8_t> payload) noexcept {
  return static_cast<Code>(payload[0]);
}

struct Reading {
  int temperature_c = 0;
  double current_a = 0.0;
  double velocity_deg_s = 0.0;
  int angle_deg = 0;  ///< Whole degrees: too coarse for anything but a look.
};
[[nodiscard]] Reading decodeReading(std::span<const std::uint8_t> payload) noexcept;

struct Status {
  int temperature_c = 0;
  bool brake_released = false;
  double voltage_v = 0.0;
  std::uint16_t errors = 0;
};
[[nodiscard]] Status decodeStatus(std::span<const std::uint8_t> payload) noexcept;

/// In 0.01 degrees.
[[nodiscard]] std::int32_t decodeAngle(std::span<const std::uint8_t> payload) noexcept;
[[nodiscard]] std::uint32_t decodeUptimeMs(std::span<const std::uint8_t> payload) noexcept;

struct MotionReading {
  std::uint8_t id = 0;
  double angle_rad = 0.0;
  double velocity_rad_s = 0.0;
  double torque_nm = 0.0;
};
[[nodiscard]] MotionReading decodeMotion(std::span<const std::uint8_t> payload) noexcept;

}  // namespace rc10::myactuator
