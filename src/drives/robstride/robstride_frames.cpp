#include "drives/robstride/robstride_frames.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "bus/byte_order.hpp"
#include "motor/drive_faults.hpp"

namespace rc10::robstride {
namespace {

constexpr double kRawFullScale = 65535.0;

// Towards zero, as the manuals' own code does; what was decoded becomes the same number again.
constexpr double kRounding = 1e-6;

std::uint16_t toRaw(double value, double low, double high) noexcept {
  const double finite = std::isnan(value) ? 0.0 : std::clamp(value, low, high);
  return static_cast<std::uint16_t>((finite - low) / (high - low) * kRawFullScale + kRounding);
}

double fromRaw(std::uint16_t raw, double low, double high) noexcept {
  return static_cast<double>(raw) * (high - low) / kRawFullScale + low;
}

double fromRaw(std::uint16_t raw, double range) noexcept { return fromRaw(raw, -range, range); }

// The fault word's bits come first: they say more than the status bits of the feedback.
constexpr std::array kRobstrideFaults{
    DriveFault{1U << 1U, FaultCode::kDriveHardware},      // driver IC
    DriveFault{1U << 8U, FaultCode::kDriveHardware},      // hardware identification
    DriveFault{1U << 9U, FaultCode::kDriveEncoder},       // position initialisation
    DriveFault{0x1'0030U, FaultCode::kDriveOverCurrent},  // phases A (16), B (4), C (5)
    DriveFault{1U << 3U, FaultCode::kDriveOverVoltage},   DriveFault{1U << 2U, FaultCode::kDriveUnderVoltage},
    DriveFault{1U << 0U, FaultCode::kDriveMotorTooHot},   DriveFault{1U << 7U, FaultCode::kDriveCalibration},
    DriveFault{1U << 14U, FaultCode::kDriveOverload},  // stalled with too much current
    DriveFault{1U << 25U, FaultCode::kDriveOverCurrent},  DriveFault{1U << 27U, FaultCode::kDriveEncoder},
    DriveFault{1U << 24U, FaultCode::kDriveUnderVoltage}, DriveFault{1U << 26U, FaultCode::kDriveMotorTooHot},
    DriveFault{1U << 28U, FaultCode::kDriveOverload},     DriveFault{1U << 29U, FaultCode::kDriveCalibration},
};
// The CyberGear calls its bits 8 to 15 overload, and the status bit 20 a hall sensor's fault.
constexpr std::uint32_t kCyberGearOverload = 0xFF00U;

}  // namespace

CanFrame Codec::operate(const SpringLaw& wanted) const noexcept {
  const double torque = model->torque_range_nm;
  std::array<std::uint8_t, 8> data{};
  writeBigEndian(data, 0, toRaw(wanted.position_rad, -position_range_rad, position_range_rad));
  writeBigEndian(data, 2,
                 toRaw(wanted.velocity_rad_s, -model->velocity_range_rad_s, model->velocity_range_rad_s));
  writeBigEndian(data, 4, toRaw(wanted.stiffness_nm_per_rad, 0.0, model->stiffness_range_nm_per_rad));
  writeBigEndian(data, 6, toRaw(wanted.damping_nms_per_rad, 0.0, model->damping_range_nms_per_rad));
  return makeClassicFrame(canId(Type::kOperate, toRaw(wanted.torque_nm, -torque, torque), drive_id), data);
}

double Codec::dampingStep() const noexcept { return model->damping_range_nms_per_rad / kRawFullScale; }

CanFrame Codec::enable() const noexcept {
  return makeClassicFrame(canId(Type::kEnable, static_cast<std::uint32_t>(host_id), drive_id),
                          std::array<std::uint8_t, 8>{});
}

CanFrame Codec::stop(bool clear_faults) const noexcept {
  return makeClassicFrame(canId(Type::kStop, static_cast<std::uint32_t>(host_id), drive_id),
                          std::array<std::uint8_t, 8>{static_cast<std::uint8_t>(clear_faults ? 1 : 0)});
}

CanFrame Codec::read(std::uint16_t index) const noexcept {
  std::array<std::uint8_t, 8> data{};
  writeLittleEndian(data, 0, index);
  return makeClassicFrame(canId(Type::kReadParameter, static_cast<std::uint32_t>(host_id), drive_id), data);
}

CanFrame Codec::write(std::uint16_t index, std::uint32_t bits) const noexcept {
  std::array<std::uint8_t, 8> data{};
  writeLittleEndian(data, 0, index);
  writeLittleEndian(data, 4, bits);
  return makeClassicFrame(canId(Type::kWriteParameter, static_cast<std::uint32_t>(host_id), drive_id), data);
}

CanFrame Codec::write(std::uint16_t index, float value) const noexcept {
  return write(index, std::bit_cast<std::uint32_t>(std::isfinite(value) ? value : 0.0F));
}

Feedback Codec::feedback(const CanFrame& frame) const noexcept {
  const auto bytes = frame.payload();
  Feedback seen;
  seen.raw_position = readBigEndian<std::uint16_t>(bytes, 0);
  seen.position_rad = fromRaw(seen.raw_position, position_range_rad);
  seen.velocity_rad_s = fromRaw(readBigEndian<std::uint16_t>(bytes, 2), model->velocity_range_rad_s);
  seen.torque_nm = fromRaw(readBigEndian<std::uint16_t>(bytes, 4), model->torque_range_nm);
  // Signed: no document says so, but no winding is at 6500 degrees either.
  seen.temperature_c = readBigEndian<std::int16_t>(bytes, 6) * 0.1;
  seen.status_bits = static_cast<std::uint8_t>(frame.id.value >> 16U & 0x3FU);
  seen.mode = static_cast<std::uint8_t>(frame.id.value >> 22U & 0x3U);
  return seen;
}

SpringLaw Codec::operation(const CanFrame& frame) const noexcept {
  const auto bytes = frame.payload();
  return {.position_rad = fromRaw(readBigEndian<std::uint16_t>(bytes, 0), position_range_rad),
          .velocity_rad_s = fromRaw(readBigEndian<std::uint16_t>(bytes, 2), model->velocity_range_rad_s),
          .stiffness_nm_per_rad =
              fromRaw(readBigEndian<std::uint16_t>(bytes, 4), 0.0, model->stiffness_range_nm_per_rad),
          .damping_nms_per_rad =
              fromRaw(readBigEndian<std::uint16_t>(bytes, 6), 0.0, model->damping_range_nms_per_rad),
          .torque_nm = fromRaw(static_cast<std::uint16_t>(frame.id.value >> 8U), model->torque_range_nm)};
}

CanFrame Codec::answer(const Feedback& told) const noexcept {
  const double velocity = model->velocity_range_rad_s;
  const double torque = model->torque_range_nm;
  std::array<std::uint8_t, 8> data{};
  writeBigEndian(data, 0, toRaw(told.position_rad, -position_range_rad, position_range_rad));
  writeBigEndian(data, 2, toRaw(told.velocity_rad_s, -velocity, velocity));
  writeBigEndian(data, 4, toRaw(told.torque_nm, -torque, torque));
  writeBigEndian(data, 6, static_cast<std::int16_t>(std::clamp(told.temperature_c * 10.0, -3e4, 3e4)));
  CanFrame frame =
      makeClassicFrame(canId(Type::kFeedback, static_cast<std::uint32_t>(drive_id), host_id), data);
  frame.id.value |= static_cast<std::uint32_t>(told.status_bits & 0x3FU) << 16U |
                    static_cast<std::uint32_t>(told.mode & 0x3U) << 22U;
  return frame;
}

CanFrame Codec::parameter(std::uint16_t index, std::uint32_t bits, bool known) const noexcept {
  std::array<std::uint8_t, 8> data{};
  writeLittleEndian(data, 0, index);
  writeLittleEndian(data, 4, bits);
  CanFrame frame =
      makeClassicFrame(canId(Type::kReadParameter, static_cast<std::uint32_t>(drive_id), host_id), data);
  if (!known) frame.id.value |= 1U << 16U;
  return frame;
}

CanFrame Codec::fault(std::uint32_t fault_word) const noexcept {
  std::array<std::uint8_t, 8> data{};
  writeLittleEndian(data, 0, fault_word);
  return makeClassicFrame(canId(Type::kFault, static_cast<std::uint32_t>(drive_id), host_id), data);
}

CanFrame Codec::identity(const std::array<std::uint8_t, 8>& unique_id) const noexcept {
  constexpr int kAllHosts = 0xFE;
  return makeClassicFrame(canId(Type::kGetId, static_cast<std::uint32_t>(drive_id), kAllHosts), unique_id);
}

FaultCode faultOf(std::uint32_t native_code, bool cyber_gear) noexcept {
  if (cyber_gear && (native_code & kCyberGearOverload) != 0) return FaultCode::kDriveOverload;
  const FaultCode fault = faultOfBits(kRobstrideFaults, native_code);
  // Status bit 20 alone remains of overload.
  return cyber_gear && fault == FaultCode::kDriveOverload ? FaultCode::kDrivePhase : fault;
}

}  // namespace rc10::robstride
