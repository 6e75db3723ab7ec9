#include "faults/wire.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "bus/can_frame.hpp"

namespace rc10::test {

bool Told::rests() const noexcept {
  if (most_effort <= 0.0) return true;  // no: kUnsaid
  switch (law) {
    case Law::kOff: return true;
    case Law::kEffort: return std::fabs(effort) <= effort_step;
    case Law::kSpring: return !stiff && !damped && std::fabs(effort) <= effort_step;
    case Law::kVelocity:
    case Law::kAngle:
    case Law::kDuty:
    case Law::kBrake: break;
  }
  return false;
}

bool Told::resistsAtMost() const noexcept {
  if (rests() || law == Law::kBrake) return true;
  const bool still = std::fabs(velocity_rpm) <= velocity_step_rpm && std::fabs(effort) <= effort_step;
  switch (law) {
    case Law::kVelocity: return still;
    case Law::kSpring: return still && !stiff;
    case Law::kDuty: return effort == 0.0;
    case Law::kOff:
    case Law::kEffort:
    case Law::kAngle:
    case Law::kBrake: break;
  }
  return false;
}

Wire::Wire(const MotorConfig& config)
    : settings_(config.settings),
      traits_(config.traits()),
      per_output_((settings_.direction < 0 ? -1.0 : 1.0) *
                  (settings_.gear_ratio > 0.0 ? settings_.gear_ratio / traits_.gear_ratio : 1.0)) {}

double Wire::rpmOfRadPerS(double drive_rad_s) const noexcept {
  return drive_rad_s * 60.0 / (2.0 * std::numbers::pi) / per_output_;
}

double Wire::degOfRad(double drive_rad) const noexcept {
  return drive_rad * 180.0 / std::numbers::pi / per_output_;
}

Told Wire::springOf(const MitFields& fields, const MitFields& steps, double position_rad,
                    double velocity_rad_s) const noexcept {
  Told told{.effort_step = std::fabs(effortOfNm(steps.torque_nm)),
            .velocity_step_rpm = std::fabs(rpmOfRadPerS(steps.velocity_rad_s))};
  const double way_rad = fields.position_rad - position_rad;
  const double change_rad_s = fields.velocity_rad_s - velocity_rad_s;
  told.effort = effortOfNm(fields.torque_nm);
  told.stiff = fields.stiffness > 0.0;
  told.damped = fields.damping > 0.0;
  told.law = told.stiff || told.damped ? Told::Law::kSpring : Told::Law::kEffort;
  if (told.damped) told.velocity_rpm = rpmOfRadPerS(fields.velocity_rad_s);
  if (told.stiff) told.ahead_deg = degOfRad(way_rad);
  told.ahead_step_deg = std::fabs(degOfRad(steps.position_rad));
  told.sum = effortOfNm(fields.torque_nm + fields.stiffness * way_rad + fields.damping * change_rad_s);
  const double rounded_nm = steps.torque_nm + steps.stiffness * std::fabs(way_rad) +
                            fields.stiffness * steps.position_rad + steps.damping * std::fabs(change_rad_s) +
                            fields.damping * steps.velocity_rad_s;
  told.sum_step = std::fabs(effortOfNm(rounded_nm));
  // Exactly there the field may be cut off, and the shaft faster.
  const bool at_end =
      speed_field_end_rad_s_ > 0.0 && std::fabs(std::fabs(velocity_rad_s) - speed_field_end_rad_s_) <=
                                          kSpeedFieldStep * speed_field_end_rad_s_;
  if (told.damped && at_end) told.sum_step = std::numeric_limits<double>::infinity();
  return told;
}

void Wire::refuse(const CanFrame& frame, const char* why) const {
  std::string bytes;
  for (const auto byte : frame.payload()) bytes += fmt::format(" {:02X}", byte);
  throw Violation(fmt::format("{} is sent {} with{}: {}", settings_.name, describe(frame.id), bytes, why));
}

std::uint32_t bigEndian(const CanFrame& frame, std::size_t at, std::size_t bytes) {
  std::uint32_t raw = 0;
  for (std::size_t i = 0; i < bytes; ++i) raw = raw << 8U | frame.data[at + i];
  return raw;
}

std::uint32_t littleEndian(const CanFrame& frame, std::size_t at, std::size_t bytes) {
  std::uint32_t raw = 0;
  for (std::size_t i = bytes; i-- > 0;) raw = raw << 8U | frame.data[at + i];
  return raw;
}

std::int16_t int16Of(std::uint32_t raw) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(raw)); }
std::int32_t int32Of(std::uint32_t raw) { return static_cast<std::int32_t>(raw); }
float floatOf(std::uint32_t raw) { return std::bit_cast<float>(raw); }

std::uint32_t bitsAt(const CanFrame& frame, std::size_t first, std::size_t bits) {
  std::uint32_t value = 0;
  for (std::size_t i = first; i < first + bits; ++i)
    value = value << 1U | ((static_cast<unsigned>(frame.data[i / 8]) >> (7 - i % 8)) & 1U);
  return value;
}

double onScale(std::uint32_t code, double low, double high, unsigned bits) {
  return low + (high - low) * static_cast<double>(code) / static_cast<double>((1U << bits) - 1U);
}

bool plainFrame(const CanFrame& frame, std::size_t length) {
  return frame.type == FrameType::kData && !frame.fd && frame.length == length;
}

bool saysSomething(const CanFrame& frame) {
  const auto bytes = frame.payload();
  return std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte != 0; });
}

bool lawOfTorque(const CanFrame& frame, std::size_t stiffness, std::size_t damping, std::size_t torque) {
  const auto code = static_cast<int>(bitsAt(frame, torque, 12));
  return bitsAt(frame, stiffness, 12) != 0 || bitsAt(frame, damping, 12) != 0 ||
         std::abs(2 * code - 4095) > 1;
}

bool isQuestionOfScan(const CanFrame& frame) {
  const std::uint32_t id = frame.id.value & 0xFFU;
  if (!frame.id.extended) return false;
  if (frame.id.value >> 8U == 0x11U) return plainFrame(frame, 1) && id <= 253U && frame.data[0] == 0xFEU;
  if (frame.id.value >> 8U != 0xFDU || !plainFrame(frame, 8) || id < 1U || id > 127U) return false;
  return bigEndian(frame, 0, 4) == 0 && bigEndian(frame, 4, 4) == 0;
}

std::unique_ptr<Wire> makeWire(const MotorConfig& config) {
  struct Maker {
    std::string_view family;
    std::unique_ptr<Wire> (*make)(const MotorConfig&);
  };
  constexpr auto kMakers = std::to_array<Maker>({{"DJI", makeDjiWire},
                                                 {"Damiao", makeDamiaoWire},
                                                 {"RobStride", makeRobstrideWire},
                                                 {"CubeMars", makeCubemarsWire},
                                                 {"ODrive", makeOdriveWire},
                                                 {"VESC", makeVescWire},
                                                 {"moteus", makeMoteusWire},
                                                 {"LK-Tech", makeLktechWire},
                                                 {"MyActuator", makeMyactuatorWire}});
  for (const auto& maker : kMakers) {
    if (maker.family == config.family->name()) return maker.make(config);
  }
  throw Violation(fmt::format("the oracle does not know the family {}", config.family->name()));
}

}  // namespace rc10::test
