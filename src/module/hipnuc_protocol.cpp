#include "module/hipnuc_protocol.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"

namespace rc10 {
namespace {

constexpr std::array<std::uint8_t, 2> kSync{0x5A, 0xA5};
constexpr std::uint8_t kPacket91 = 0x91;
constexpr std::size_t kPacket91Bytes = 76;

// Offsets in packet 0x91; each value is a float.
constexpr std::size_t kAccelerationAt = 12;  // g
constexpr std::size_t kRatesAt = 24;         // deg/s
constexpr std::size_t kAnglesAt = 48;        // roll, pitch, yaw in degrees
constexpr std::size_t kQuaternionAt = 60;    // w, x, y, z
constexpr std::size_t kValuesEnd = 76;

[[nodiscard]] ScanVerdict judgeHipnuc(std::span<const std::uint8_t> shown) noexcept {
  if (shown.size() <= kSync.size()) {
    return shown.back() == kSync[shown.size() - 1] ? ScanVerdict::kMore : ScanVerdict::kNoise;
  }
  if (shown.size() < HipnucProtocol::kHeaderBytes) return ScanVerdict::kMore;
  const std::size_t length = readLittleEndian<std::uint16_t>(shown, 2);
  if (length == 0 || length > HipnucProtocol::kLongestPayload) return ScanVerdict::kNoise;
  if (shown.size() < HipnucProtocol::kHeaderBytes + length) return ScanVerdict::kMore;
  // The checksum leaves itself out.
  const auto checksum = crc16Xmodem(shown.subspan(HipnucProtocol::kHeaderBytes), crc16Xmodem(shown.first(4)));
  return checksum == readLittleEndian<std::uint16_t>(shown, 4) ? ScanVerdict::kFrame
                                                               : ScanVerdict::kBadChecksum;
}

[[nodiscard]] float number(std::span<const std::uint8_t> payload, std::size_t at,
                           std::size_t index) noexcept {
  return readLittleEndian<float>(payload, at + 4 * index);
}

// A checksum says that the numbers are as they were sent, not that they are numbers.
[[nodiscard]] bool allFinite(std::span<const std::uint8_t> payload) noexcept {
  for (std::size_t at = kAccelerationAt; at < kValuesEnd; at += 4) {
    if (!std::isfinite(readLittleEndian<float>(payload, at))) return false;
  }
  return true;
}

}  // namespace

void HipnucProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  scanner_.scan(bytes, counters_, [&](std::span<const std::uint8_t> shown) {
    const auto verdict = judgeHipnuc(shown);
    if (verdict == ScanVerdict::kFrame) take(shown.subspan(kHeaderBytes), received);
    return verdict;
  });
}

void HipnucProtocol::take(std::span<const std::uint8_t> payload, MonotonicTime received) noexcept {
  if (payload.size() < kPacket91Bytes || payload[0] != kPacket91 || !allFinite(payload)) return;
  const auto value = [&](std::size_t at, std::size_t index) { return number(payload, at, index); };
  acceleration_.set(
      {value(kAccelerationAt, 0) * kStandardGravity, value(kAccelerationAt, 1) * kStandardGravity,
       value(kAccelerationAt, 2) * kStandardGravity},
      received);
  rates_.set({value(kRatesAt, 0), value(kRatesAt, 1), value(kRatesAt, 2)}, received);
  angles_.set({value(kAnglesAt, 0), value(kAnglesAt, 1), value(kAnglesAt, 2)}, received);
  quaternion_.set(
      {value(kQuaternionAt, 0), value(kQuaternionAt, 1), value(kQuaternionAt, 2), value(kQuaternionAt, 3)},
      received);
}

std::size_t HipnucProtocol::pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept {
  if (payload.empty() || out.size() < payload.size() + 2) return 0;
  std::copy(payload.begin(), payload.end(), out.begin());
  out[payload.size()] = '\r';
  out[payload.size() + 1] = '\n';
  return payload.size() + 2;
}

}  // namespace rc10
