#include "drives/damiao/damiao_frames.hpp"

#include <algorithm>
#include <cmath>

#include "bus/byte_order.hpp"

namespace rc10::damiao {
namespace {

constexpr std::uint8_t kLastRegister = 81;

constexpr double full(unsigned bits) noexcept { return static_cast<double>((1U << bits) - 1U); }

std::uint8_t low(std::uint16_t code) noexcept { return static_cast<std::uint8_t>(code & 0xFFU); }

/// To [0, 65535] without wrapping; NaN: 0.
std::uint16_t whole(double value, double most) noexcept {
  return static_cast<std::uint16_t>(value > 0.0 ? std::min(value, most) : 0.0);
}

Payload registerFrame(int id, std::uint8_t operation, Register address) noexcept {
  return {static_cast<std::uint8_t>(id), 0, operation, static_cast<std::uint8_t>(address)};
}

}  // namespace

std::uint16_t toCode(double value, double limit, unsigned bits) noexcept {
  const double within = std::isnan(value) ? 0.0 : std::clamp(value, -limit, limit);
  // The nudge keeps what fromCode() gave at its own code.
  return whole((within + limit) * full(bits) / (2.0 * limit) + 1e-9, full(bits));
}

double fromCode(double code, double limit, unsigned bits) noexcept {
  return code * (2.0 * limit) / full(bits) - limit;
}

double positionStep(const DamiaoScale& scale) noexcept { return 2.0 * scale.p_max_rad / full(16); }

double torqueStep(const DamiaoScale& scale) noexcept { return 2.0 * scale.t_max_nm / full(12); }

Payload special(Special command) noexcept {
  return {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, static_cast<std::uint8_t>(command)};
}

Payload mit(const SpringLaw& command, const DamiaoScale& scale) noexcept {
  const auto gain = [](double value, double most) { return whole(value / most * full(12) + 1e-9, full(12)); };
  const auto position = toCode(command.position_rad, scale.p_max_rad, 16);
  const auto velocity = toCode(command.velocity_rad_s, scale.v_max_rad_s, 12);
  const auto torque = toCode(command.torque_nm, scale.t_max_nm, 12);
  const auto kp = gain(command.stiffness_nm_per_rad, kKpMax);
  const auto kd = gain(command.damping_nms_per_rad, kKdMax);
  Payload out{};
  writeBigEndian(out, 0, position);
  out[2] = static_cast<std::uint8_t>(velocity >> 4U);
  out[3] = static_cast<std::uint8_t>((velocity & 0xFU) << 4U | kp >> 8U);
  out[4] = low(kp);
  out[5] = static_cast<std::uint8_t>(kd >> 4U);
  out[6] = static_cast<std::uint8_t>((kd & 0xFU) << 4U | torque >> 8U);
  out[7] = low(torque);
  return out;
}

SpringLaw readMit(std::span<const std::uint8_t, 8> payload, const DamiaoScale& scale) noexcept {
  const auto at = [payload](std::size_t byte) { return static_cast<unsigned>(payload[byte]); };
  return {.position_rad = fromCode(readBigEndian<std::uint16_t>(payload, 0), scale.p_max_rad, 16),
          .velocity_rad_s = fromCode(at(2) << 4U | at(3) >> 4U, scale.v_max_rad_s, 12),
          .stiffness_nm_per_rad = ((at(3) & 0xFU) << 8U | at(4)) * kKpMax / full(12),
          .damping_nms_per_rad = (at(5) << 4U | at(6) >> 4U) * kKdMax / full(12),
          .torque_nm = fromCode((at(6) & 0xFU) << 8U | at(7), scale.t_max_nm, 12)};
}

Payload positionVelocity(float position_rad, float limit_rad_s) noexcept {
  Payload out{};
  writeLittleEndian(out, 0, position_rad);
  writeLittleEndian(out, 4, limit_rad_s);
  return out;
}

Payload forcePosition(float position_rad, double limit_rad_s, double current_pu) noexcept {
  constexpr double kMost = 10000.0;  // 100 rad/s, and all of the current
  Payload out{};
  writeLittleEndian(out, 0, position_rad);
  writeLittleEndian(out, 4, whole(limit_rad_s * 100.0 + 1e-6, kMost));
  writeLittleEndian(out, 6, whole(current_pu * 10000.0 + 1e-6, kMost));
  return out;
}

Payload readRegister(int id, Register address) noexcept { return registerFrame(id, kReadOperation, address); }

Payload writeRegister(int id, Register address, std::uint32_t value) noexcept {
  Payload out = registerFrame(id, kWriteOperation, address);
  writeLittleEndian(out, 4, value);
  return out;
}

Payload saveRegisters(int id) noexcept { return registerFrame(id, kSaveOperation, Register{1}); }

std::array<std::uint8_t, 4> velocity(float rad_s) noexcept {
  std::array<std::uint8_t, 4> out{};
  writeLittleEndian(out, 0, rad_s);
  return out;
}

State readState(std::span<const std::uint8_t, 8> payload) noexcept {
  const auto at = [payload](std::size_t byte) { return static_cast<unsigned>(payload[byte]); };
  return {.status = static_cast<std::uint8_t>(at(0) >> 4U),
          .position = readBigEndian<std::uint16_t>(payload, 1),
          .velocity = static_cast<std::uint16_t>(at(3) << 4U | at(4) >> 4U),
          .torque = static_cast<std::uint16_t>((at(4) & 0xFU) << 8U | at(5)),
          .drive_temperature = payload[6],
          .winding_temperature = payload[7]};
}

Payload writeState(int id, const State& state) noexcept {
  Payload out{};
  out[0] = static_cast<std::uint8_t>(state.status << 4U | id);
  writeBigEndian(out, 1, state.position);
  out[3] = static_cast<std::uint8_t>(state.velocity >> 4U);
  out[4] = static_cast<std::uint8_t>((state.velocity & 0xFU) << 4U | (state.torque >> 8U & 0xFU));
  out[5] = low(state.torque);
  out[6] = state.drive_temperature;
  out[7] = state.winding_temperature;
  return out;
}

std::optional<RegisterReply> readReply(std::span<const std::uint8_t, 8> payload, int id) noexcept {
  if (payload[0] != id || payload[1] != 0 || payload[3] > kLastRegister) return std::nullopt;
  const std::uint8_t operation = payload[2];
  if (operation != kReadOperation && operation != kWriteOperation && operation != kSaveOperation)
    return std::nullopt;
  return RegisterReply{
      .id = payload[0],
      .written = operation != kReadOperation,
      .address = operation == kSaveOperation ? Register{} : static_cast<Register>(payload[3]),
      .value = readLittleEndian<std::uint32_t>(payload, 4)};
}

std::uint32_t bitsOf(float value) noexcept {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

float floatOf(std::uint32_t bits) noexcept {
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

float temperature(std::uint8_t byte) noexcept {
  constexpr int kHottest = 200;  // the drive's own limit can be set up to here
  const int value = byte;
  return static_cast<float>(value > kHottest ? value - 256 : value);
}

FaultCode faultOf(std::uint8_t status) noexcept {
  // Manual, "LED Status" (3 to E) and "Feedback Frames"; 2 from firmware V3. The names of our codes.
  static constexpr std::array<FaultCode, 16> kFaults{
      FaultCode::kNone,                // 0 disabled
      FaultCode::kNone,                // 1 enabled
      FaultCode::kDriveCalibration,    // 2 calibration of the output is missing
      FaultCode::kDriveCalibration,    // 3 calibration of the output is wrong
      FaultCode::kDriveEncoder,        // 4 output of a sensor
      FaultCode::kDriveCalibration,    // 5 calibration of the motor's encoder
      FaultCode::kDriveOther,          // 6
      FaultCode::kDriveOther,          // 7
      FaultCode::kDriveOverVoltage,    // 8
      FaultCode::kDriveUnderVoltage,   // 9
      FaultCode::kDriveOverCurrent,    // A
      FaultCode::kDriveTooHot,         // B power stage
      FaultCode::kDriveMotorTooHot,    // C winding
      FaultCode::kDriveCommunication,  // D its watchdog
      FaultCode::kDriveOverload,       // E
      FaultCode::kDriveOther};         // F
  return kFaults[status & 0xFU];
}

}  // namespace rc10::damiao
