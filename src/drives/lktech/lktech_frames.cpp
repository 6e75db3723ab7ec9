#include "drives/lktech/lktech_frames.hpp"

#include <algorithm>

#include "app/saturated.hpp"
#include "bus/byte_order.hpp"

namespace rc10::lktech {
namespace {

constexpr double kVoltsPerRaw = 0.01;
constexpr std::uint8_t kOffState = 0x10;

std::int16_t bounded(int raw, int limit) noexcept {
  return static_cast<std::int16_t>(std::clamp(raw, -limit, limit));
}

bool zeros(std::span<const std::uint8_t> bytes) noexcept {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace

CanFrame request(int id, Code code) noexcept {
  CanFrame frame;
  frame.id = {kBaseId + static_cast<std::uint32_t>(id), false};
  frame.length = kLength;
  frame.data[0] = static_cast<std::uint8_t>(code);
  return frame;
}

CanFrame currentCommand(int id, int raw) noexcept {
  CanFrame frame = request(id, Code::kCurrent);
  writeLittleEndian(frame.data, 4, bounded(raw, kRawCurrentMax));
  return frame;
}

CanFrame velocityCommand(int id, double rotor_deg_s, int limit_raw) noexcept {
  CanFrame frame = request(id, Code::kVelocity);
  writeLittleEndian(frame.data, 2, bounded(limit_raw, kRawCurrentMax));
  writeLittleEndian(frame.data, 4, saturatedRound<std::int32_t>(rotor_deg_s / kDegPerRaw));
  return frame;
}

CanFrame positionCommand(int id, double rotor_deg, double limit_deg_s) noexcept {
  CanFrame frame = request(id, Code::kPosition);
  const auto limit = saturatedRound<std::uint16_t>(limit_deg_s);
  writeLittleEndian(frame.data, 2, std::max<std::uint16_t>(limit, 1));
  writeLittleEndian(frame.data, 4, saturatedRound<std::int32_t>(rotor_deg / kDegPerRaw));
  return frame;
}

CanFrame groupCommand(const std::array<int, kGroupSize>& raw) noexcept {
  CanFrame frame;
  frame.id = {kGroupId, false};
  frame.length = kLength;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    writeLittleEndian(frame.data, 2 * i, bounded(raw[i], kRawGroupCurrentMax));
  }
  return frame;
}

bool looksLikeCommand(std::span<const std::uint8_t> payload) noexcept {
  switch (codeOf(payload)) {
    case Code::kCurrent: return zeros(payload.subspan(1, 3)) && zeros(payload.subspan(6));
    case Code::kVelocity:
    case Code::kPosition: return payload[1] == 0;
    default: break;
  }
  const bool moves = (payload[0] & 0xF0U) == 0xA0U;  // with parameters, of which the first is 0 in most
  return moves ? payload[1] == 0 : zeros(payload.subspan(1));
}

Reading decodeReading(std::span<const std::uint8_t> payload) noexcept {
  return {.temperature_c = static_cast<std::int8_t>(payload[1]),
          .current_raw = readLittleEndian<std::int16_t>(payload, 2),
          .rotor_deg_s = readLittleEndian<std::int16_t>(payload, 4),
          .encoder = readLittleEndian<std::uint16_t>(payload, 6)};
}

Status decodeStatus(std::span<const std::uint8_t> payload) noexcept {
  return {.temperature_c = static_cast<std::int8_t>(payload[1]),
          .voltage_v = readLittleEndian<std::uint16_t>(payload, 2) * kVoltsPerRaw,
          .off = (payload[6] & kOffState) != 0,
          .errors = payload[7]};
}

std::int64_t decodeAngle(std::span<const std::uint8_t> payload) noexcept {
  const auto with_code = readLittleEndian<std::uint64_t>(payload, 0);
  return static_cast<std::int64_t>(with_code) >> 8U;
}

}  // namespace rc10::lktech
