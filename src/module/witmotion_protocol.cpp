#include "module/witmotion_protocol.hpp"

#include <algorithm>
#include <array>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"

namespace rc10 {
namespace {

constexpr std::uint8_t kWitmotionHeader = 0x55;
constexpr std::uint8_t kFirstType = 0x50;
constexpr std::uint8_t kLastType = 0x5F;

enum Type : std::uint8_t { kAcceleration = 0x51, kRates = 0x52, kAngles = 0x53, kQuaternion = 0x59 };

// Full scale of an int16, whatever range the sensor chip is set to.
constexpr float kFullAcceleration = 16.0F * kStandardGravity;  // m/s^2
constexpr float kFullRate = 2000.0F;                           // deg/s
constexpr float kFullAngle = 180.0F;                           // deg

[[nodiscard]] float scaled(std::span<const std::uint8_t> frame, std::size_t index, float full) noexcept {
  return static_cast<float>(readLittleEndian<std::int16_t>(frame, 2 + 2 * index)) / 32768.0F * full;
}

[[nodiscard]] std::array<float, 3> axes(std::span<const std::uint8_t> frame, float full) noexcept {
  return {scaled(frame, 0, full), scaled(frame, 1, full), scaled(frame, 2, full)};
}

[[nodiscard]] ScanVerdict judgeWitmotion(std::span<const std::uint8_t> shown) noexcept {
  if (shown[0] != kWitmotionHeader) return ScanVerdict::kNoise;
  if (shown.size() > 1 && (shown[1] < kFirstType || shown[1] > kLastType)) return ScanVerdict::kNoise;
  if (shown.size() < WitMotionProtocol::kFrameBytes) return ScanVerdict::kMore;
  return sum8(shown.first(WitMotionProtocol::kFrameBytes - 1)) == shown.back() ? ScanVerdict::kFrame
                                                                               : ScanVerdict::kBadChecksum;
}

}  // namespace

void WitMotionProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  scanner_.scan(bytes, counters_, [&](std::span<const std::uint8_t> shown) {
    const auto verdict = judgeWitmotion(shown);
    if (verdict == ScanVerdict::kFrame) take(shown, received);
    return verdict;
  });
}

void WitMotionProtocol::take(std::span<const std::uint8_t> frame, MonotonicTime received) noexcept {
  switch (frame[1]) {
    case kAcceleration: {
      const auto [x, y, z] = axes(frame, kFullAcceleration);
      return acceleration_.set({x, y, z}, received);
    }
    case kRates: {
      const auto [x, y, z] = axes(frame, kFullRate);
      return rates_.set({x, y, z}, received);
    }
    case kAngles: {
      const auto [roll, pitch, yaw] = axes(frame, kFullAngle);
      return angles_.set({roll, pitch, yaw}, received);
    }
    case kQuaternion:
      return quaternion_.set(
          {scaled(frame, 0, 1.0F), scaled(frame, 1, 1.0F), scaled(frame, 2, 1.0F), scaled(frame, 3, 1.0F)},
          received);
    default: return;  // time, magnetic field, pressure, position: not used
  }
}

std::size_t WitMotionProtocol::pack_frame(std::span<const std::uint8_t> payload,
                                          std::span<std::uint8_t> out) const noexcept {
  if (payload.size() != 3 || out.size() < 5) return 0;
  out[0] = 0xFF;
  out[1] = 0xAA;
  std::copy(payload.begin(), payload.end(), out.begin() + 2);
  return 5;
}

}  // namespace rc10
