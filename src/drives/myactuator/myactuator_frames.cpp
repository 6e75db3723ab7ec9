#include "drives/myactuator/myactuator_frames.hpp"

#include <algorithm>
#include <cmath>

#include "app/saturated.hpp"
#include "bus/byte_order.hpp"

namespace rc10::myactuator {
namespace {

constexpr double kVoltsPerRaw = 0.1;

CanFrame empty(std::uint32_t id) noexcept {
  CanFrame frame;
  frame.id = {id, false};
  frame.length = kLength;
  return frame;
}

/// A number in [-range, range] (or [0, range]) as `bits` bits.
std::uint32_t pack(double value, double low, double high, unsigned bits) noexcept {
  const double full_scale = static_cast<double>((1U << bits) - 1U);
  const double inside = std::isnan(value) ? std::max(low, 0.0) : std::clamp(value, low, high);
  return saturatedRound<std::uint32_t>((inside - low) / (high - low) * full_scale);
}

double unpack(std::uint32_t raw, double low, double high, unsigned bits) noexcept {
  return low + static_cast<double>(raw) * (high - low) / static_cast<double>((1U << bits) - 1U);
}

}  // namespace

CanFrame request(int id, Code code) noexcept {
  CanFrame frame = empty(kRequestBase + static_cast<std::uint32_t>(id));
  frame.data[0] = static_cast<std::uint8_t>(code);
  return frame;
}

CanFrame currentCommand(int id, double current_a) noexcept {
  CanFrame frame = request(id, Code::kCurrent);
  writeLittleEndian(frame.data, 4, saturatedRound<std::int16_t>(current_a / kAmperesPerRaw));
  return frame;
}

CanFrame velocityCommand(int id, double velocity_deg_s) noexcept {
  CanFrame frame = request(id, Code::kVelocity);
  writeLittleEndian(frame.data, 4, saturatedRound<std::int32_t>(velocity_deg_s / kDegPerRaw));
  return frame;
}

CanFrame positionCommand(int id, double angle_deg, double limit_deg_s) noexcept {
  CanFrame frame = request(id, Code::kPosition);
  const auto limit = saturatedRound<std::uint16_t>(limit_deg_s);
  writeLittleEndian(frame.data, 2, std::max<std::uint16_t>(limit, 1));
  writeLittleEndian(frame.data, 4, saturatedRound<std::int32_t>(angle_deg / kDegPerRaw));
  return frame;
}

CanFrame motionCommand(int id, const SpringLaw& motion) noexcept {
  CanFrame frame = empty(kMotionBase + static_cast<std::uint32_t>(id));
  const auto angle = pack(motion.position_rad, -kMotionAngleRad, kMotionAngleRad, 16);
  const auto velocity = pack(motion.velocity_rad_s, -kMotionVelocityRadS, kMotionVelocityRadS, 12);
  const auto stiffness = pack(motion.stiffness_nm_per_rad, 0.0, kMotionStiffness, 12);
  const auto damping = pack(motion.damping_nms_per_rad, 0.0, kMotionDamping, 12);
  const auto torque = pack(motion.torque_nm, -kMotionTorqueNm, kMotionTorqueNm, 12);
  writeBigEndian(frame.data, 0, static_cast<std::uint16_t>(angle));
  // Twelve bits each: velocity and stiffness, then damping and torque.
  const std::uint32_t first = velocity << 12U | stiffness;
  const std::uint32_t second = damping << 12U | torque;
  for (unsigned i = 0; i < 3; ++i) {
    frame.data[2 + i] = static_cast<std::uint8_t>(first >> (16U - 8U * i) & 0xFFU);
    frame.data[5 + i] = static_cast<std::uint8_t>(second >> (16U - 8U * i) & 0xFFU);
  }
  return frame;
}

Reading decodeReading(std::span<const std::uint8_t> payload) noexcept {
  return {.temperature_c = static_cast<std::int8_t>(payload[1]),
          .current_a = readLittleEndian<std::int16_t>(payload, 2) * kAmperesPerRaw,
          .velocity_deg_s = static_cast<double>(readLittleEndian<std::int16_t>(payload, 4)),
          .angle_deg = readLittleEndian<std::int16_t>(payload, 6)};
}

Status decodeStatus(std::span<const std::uint8_t> payload) noexcept {
  return {.temperature_c = static_cast<std::int8_t>(payload[1]),
          .brake_released = payload[3] != 0,
          .voltage_v = readLittleEndian<std::uint16_t>(payload, 4) * kVoltsPerRaw,
          .errors = readLittleEndian<std::uint16_t>(payload, 6)};
}

std::int32_t decodeAngle(std::span<const std::uint8_t> payload) noexcept {
  return readLittleEndian<std::int32_t>(payload, 4);
}

std::uint32_t decodeUptimeMs(std::span<const std::uint8_t> payload) noexcept {
  return readLittleEndian<std::uint32_t>(payload, 4);
}

MotionReading decodeMotion(std::span<const std::uint8_t> payload) noexcept {
  const std::uint32_t velocity =
      static_cast<std::uint32_t>(payload[3]) << 4U | static_cast<std::uint32_t>(payload[4]) >> 4U;
  const std::uint32_t torque = (static_cast<std::uint32_t>(payload[4]) & 0xFU) << 8U | payload[5];
  return {
      .id = payload[0],
      .angle_rad = unpack(readBigEndian<std::uint16_t>(payload, 1), -kMotionAngleRad, kMotionAngleRad, 16),
      .velocity_rad_s = unpack(velocity, -kMotionVelocityRadS, kMotionVelocityRadS, 12),
      .torque_nm = unpack(torque, -kMotionTorqueNm, kMotionTorqueNm, 12)};
}

}  // namespace rc10::myactuator
