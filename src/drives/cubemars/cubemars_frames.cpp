#include "drives/cubemars/cubemars_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "app/limits.hpp"
#include "app/saturated.hpp"
#include "bus/byte_order.hpp"

namespace rc10::cubemars {
namespace {

// Scales of the servo frames. The position is 1e4 per degree over CAN (1e6 is the UART's: it would not
// fit beyond 2147 degrees).
constexpr double kDutyScale = 1e5;
constexpr double kCurrentScale = 1e3;
constexpr double kPositionScale = 1e4;
constexpr double kTenth = 0.1;

// Ranges of the manual.
constexpr double kLargestA = 60.0;
constexpr double kLargestDeg = 36'000.0;
constexpr int kPositionCutOff = 32'000;  // of 0.1 degrees in the feedback

constexpr int kMitTemperatureOffsetC = 40;  // cubemars_driver_node and the manual's example

[[nodiscard]] double within(double value, double limit) noexcept { return std::clamp(value, -limit, limit); }

[[nodiscard]] CanFrame int32Frame(ServoCommand command, int motor_id, double value) noexcept {
  std::array<std::uint8_t, 4> data{};
  writeBigEndian(data, 0, saturatedRound<std::int32_t>(value));
  return makeClassicFrame(servoId(command, motor_id), data);
}

/// `value` from `low` to `high` as a number of `bits`, cut off like the vendor's code does.
[[nodiscard]] std::uint32_t toCode(double value, double low, double high, unsigned bits) noexcept {
  const double codes = static_cast<double>((1U << bits) - 1U);
  constexpr double kRounding = 1e-9;  // a number that was decoded becomes the same again
  const double code = (value - low) / (high - low) * codes + kRounding;
  return std::isnan(code) ? 0U : static_cast<std::uint32_t>(std::clamp(code, 0.0, codes));
}

[[nodiscard]] double fromCode(std::uint32_t code, double low, double high, unsigned bits) noexcept {
  return low + (high - low) * static_cast<double>(code) / static_cast<double>((1U << bits) - 1U);
}

/// Codes of a command.
struct MitCodes {
  std::uint32_t position;
  std::uint32_t velocity;
  std::uint32_t stiffness;
  std::uint32_t damping;
  std::uint32_t torque;
};

[[nodiscard]] MitCodes toCodes(const CubemarsRanges& r, const SpringLaw& c) noexcept {
  return {.position =
              toCode(finiteOr0(within(c.position_rad, r.position_rad)), -r.position_rad, r.position_rad, 16),
          .velocity = toCode(finiteOr0(within(c.velocity_rad_s, r.velocity_rad_s)), -r.velocity_rad_s,
                             r.velocity_rad_s, 12),
          .stiffness = toCode(c.stiffness_nm_per_rad, 0.0, CubemarsRanges::kStiffnessNmPerRad, 12),
          .damping = toCode(c.damping_nms_per_rad, 0.0, CubemarsRanges::kDampingNmsPerRad, 12),
          .torque = toCode(finiteOr0(within(c.torque_nm, r.torque_nm)), -r.torque_nm, r.torque_nm, 12)};
}

[[nodiscard]] constexpr std::uint8_t byte(std::uint32_t value) noexcept {
  return static_cast<std::uint8_t>(value & 0xFFU);
}

/// Two 12-bit numbers in three bytes.
void writePair(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t first,
               std::uint32_t second) noexcept {
  bytes[at] = byte(first >> 4U);
  bytes[at + 1] = byte((first & 0xFU) << 4U | second >> 8U);
  bytes[at + 2] = byte(second);
}

}  // namespace

CanFrame dutyFrame(int motor_id, double duty) noexcept {
  return int32Frame(ServoCommand::kDuty, motor_id, within(duty, 1.0) * kDutyScale);
}

CanFrame currentFrame(int motor_id, double amperes) noexcept {
  return int32Frame(ServoCommand::kCurrent, motor_id, within(amperes, kLargestA) * kCurrentScale);
}

CanFrame brakeFrame(int motor_id, double amperes) noexcept {
  return int32Frame(ServoCommand::kBrakeCurrent, motor_id,
                    std::clamp(amperes, 0.0, kLargestA) * kCurrentScale);
}

CanFrame velocityFrame(int motor_id, double erpm) noexcept {
  return int32Frame(ServoCommand::kVelocity, motor_id, within(erpm, kLargestErpm));
}

CanFrame positionFrame(int motor_id, double degrees) noexcept {
  return int32Frame(ServoCommand::kPosition, motor_id, within(degrees, kLargestDeg) * kPositionScale);
}

CanFrame positionVelocityFrame(int motor_id, double degrees, double erpm, double erpm_per_s) noexcept {
  std::array<std::uint8_t, 8> data{};
  writeBigEndian(data, 0, saturatedRound<std::int32_t>(within(degrees, kLargestDeg) * kPositionScale));
  // Some old code sends these two without the division by 10; the manual and all newer code divide.
  writeBigEndian(data, 4, saturatedRound<std::int16_t>(std::max(erpm, 0.0) * kTenth));
  writeBigEndian(data, 6, saturatedRound<std::int16_t>(std::max(erpm_per_s, 0.0) * kTenth));
  return makeClassicFrame(servoId(ServoCommand::kPositionVelocity, motor_id), data);
}

std::optional<ServoReport> readServoReport(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd || frame.length != 8) return std::nullopt;
  const auto payload = frame.payload();
  const int position = readBigEndian<std::int16_t>(payload, 0);
  ServoReport report;
  report.degrees = kTenth * position;
  report.position_cut_off = std::abs(position) >= kPositionCutOff;
  report.erpm = 10.0 * readBigEndian<std::int16_t>(payload, 2);
  report.amperes = 0.01 * readBigEndian<std::int16_t>(payload, 4);
  report.temperature_c = payload[6] < 0x80 ? payload[6] : payload[6] - 0x100;  // signed
  report.error = payload[7];
  return report;
}

CanFrame mitFrame(int motor_id, const CubemarsRanges& ranges, const SpringLaw& command) noexcept {
  const MitCodes codes = toCodes(ranges, command);
  std::array<std::uint8_t, 8> data{};
  data[0] = byte(codes.position >> 8U);
  data[1] = byte(codes.position);
  writePair(data, 2, codes.velocity, codes.stiffness);
  writePair(data, 5, codes.damping, codes.torque);
  return makeClassicFrame(mitId(motor_id), data);
}

CanFrame mitV3Frame(int motor_id, const CubemarsRanges& ranges, const SpringLaw& command) noexcept {
  const MitCodes codes = toCodes(ranges, command);
  std::array<std::uint8_t, 8> data{};
  writePair(data, 0, codes.stiffness, codes.damping);
  data[3] = byte(codes.position >> 8U);
  data[4] = byte(codes.position);
  writePair(data, 5, codes.velocity, codes.torque);
  return makeClassicFrame(servoId(ServoCommand::kMit, motor_id), data);
}

CanFrame mitOrderFrame(int motor_id, MitOrder order) noexcept {
  std::array<std::uint8_t, 8> data{};
  data.fill(0xFF);
  data[7] = static_cast<std::uint8_t>(order);
  return makeClassicFrame(mitId(motor_id), data);
}

std::optional<MitReport> readMitReport(const CanFrame& frame, const CubemarsRanges& ranges) noexcept {
  const bool length_known = frame.length == 8 || frame.length == 6;
  if (frame.type != FrameType::kData || frame.fd || !length_known) return std::nullopt;
  const auto& data = frame.data;
  const std::uint32_t position = readBigEndian<std::uint16_t>(frame.payload(), 1);
  const std::uint32_t velocity = static_cast<std::uint32_t>(data[3]) << 4U | data[4] >> 4U;
  const std::uint32_t torque = (data[4] & 0xFU) << 8U | data[5];
  MitReport report;
  report.motor_id = data[0];
  report.position_rad = fromCode(position, -ranges.position_rad, ranges.position_rad, 16);
  report.at_end = position == 0 || position == 0xFFFFU;
  report.velocity_rad_s = fromCode(velocity, -ranges.velocity_rad_s, ranges.velocity_rad_s, 12);
  report.speed_at_end = velocity == 0 || velocity == 0xFFFU;
  report.torque_nm = fromCode(torque, -ranges.torque_nm, ranges.torque_nm, 12);
  if (frame.length == 8) {
    report.temperature_c = data[6] - kMitTemperatureOffsetC;
    report.error = data[7];
  }
  return report;
}

}  // namespace rc10::cubemars
