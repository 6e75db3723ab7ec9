#include "drives/vesc/vesc_frames.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "bus/byte_order.hpp"

namespace rc10::vesc {
namespace {

constexpr std::uint8_t kGetValuesSelective = 50;
constexpr std::uint8_t kAnswerToSender = 0;
constexpr std::size_t kAnswerLength = 8;  // sender, kind, 50, mask (4), value

float scaled16(const CanFrame& frame, std::size_t at, float per_unit) noexcept {
  return static_cast<float>(readBigEndian<std::int16_t>(frame.payload(), at)) / per_unit;
}

double scaled32(const CanFrame& frame, std::size_t at, double per_unit) noexcept {
  return static_cast<double>(readBigEndian<std::int32_t>(frame.payload(), at)) / per_unit;
}

}  // namespace

std::int32_t toRaw(double value, double scale) noexcept {
  const double raw = std::round(value * scale);
  if (std::isnan(raw)) return 0;
  if (raw >= static_cast<double>(std::numeric_limits<std::int32_t>::max())) {
    return std::numeric_limits<std::int32_t>::max();
  }
  if (raw <= static_cast<double>(std::numeric_limits<std::int32_t>::min())) {
    return std::numeric_limits<std::int32_t>::min();
  }
  return static_cast<std::int32_t>(raw);
}

CanFrame makeCommand(Packet packet, int controller_id, std::int32_t raw) noexcept {
  std::array<std::uint8_t, 4> payload{};
  writeBigEndian<std::int32_t>(payload, 0, raw);
  return makeClassicFrame(canId(packet, controller_id), payload);
}

CanFrame makeQuestion(int controller_id, int host_id, std::uint32_t mask) noexcept {
  std::array<std::uint8_t, 7> payload{static_cast<std::uint8_t>(host_id), kAnswerToSender,
                                      kGetValuesSelective};
  writeBigEndian<std::uint32_t>(payload, 3, mask);
  return makeClassicFrame(canId(Packet::kProcessShortBuffer, controller_id), payload);
}

std::optional<Answer> decodeAnswer(const CanFrame& frame) noexcept {
  if (frame.length != kAnswerLength || frame.data[2] != kGetValuesSelective) return std::nullopt;
  const Answer answer{.mask = readBigEndian<std::uint32_t>(frame.payload(), 3), .value = frame.data[7]};
  if (answer.mask != kAskFault && answer.mask != kAskStatus) return std::nullopt;
  return answer;
}

Status1 decodeStatus1(const CanFrame& frame) noexcept {
  return {.erpm = readBigEndian<std::int32_t>(frame.payload(), 0),
          .current_a = scaled16(frame, 4, 10.0F),
          .duty = scaled16(frame, 6, 1000.0F)};
}

Status2 decodeStatus2(const CanFrame& frame) noexcept {
  return {.charge_used_ah = scaled32(frame, 0, 1e4), .charge_returned_ah = scaled32(frame, 4, 1e4)};
}

Status3 decodeStatus3(const CanFrame& frame) noexcept {
  return {.energy_used_wh = scaled32(frame, 0, 1e4), .energy_returned_wh = scaled32(frame, 4, 1e4)};
}

Status4 decodeStatus4(const CanFrame& frame) noexcept {
  return {.drive_c = scaled16(frame, 0, 10.0F),
          .motor_c = scaled16(frame, 2, 10.0F),
          .input_a = scaled16(frame, 4, 10.0F),
          .position_deg = scaled16(frame, 6, 50.0F)};
}

Status5 decodeStatus5(const CanFrame& frame) noexcept {
  return {.steps = readBigEndian<std::int32_t>(frame.payload(), 0), .input_v = scaled16(frame, 4, 10.0F)};
}

Status6 decodeStatus6(const CanFrame& frame) noexcept {
  return {.adc1_v = scaled16(frame, 0, 1000.0F),
          .adc2_v = scaled16(frame, 2, 1000.0F),
          .adc3_v = scaled16(frame, 4, 1000.0F),
          .ppm = scaled16(frame, 6, 1000.0F)};
}

}  // namespace rc10::vesc
