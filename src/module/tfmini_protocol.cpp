#include "module/tfmini_protocol.hpp"

#include <algorithm>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"

namespace rc10 {
namespace {

constexpr std::uint8_t kTfminiHeader = 0x59;
constexpr std::uint8_t kCommandHeader = 0x5A;
constexpr std::size_t kLongestCommand = 8;

constexpr std::uint16_t kWeakest = 100;
constexpr std::uint16_t kOverexposed = 65535;
// Instead of a distance: 65535 too weak, 65534 saturated, 65532 too much daylight.
constexpr std::uint16_t kFirstErrorDistance = 65532;

[[nodiscard]] ScanVerdict judgeTfmini(std::span<const std::uint8_t> shown) noexcept {
  if (shown.size() <= 2) return shown.back() == kTfminiHeader ? ScanVerdict::kMore : ScanVerdict::kNoise;
  if (shown.size() < TfminiProtocol::kFrameBytes) return ScanVerdict::kMore;
  return sum8(shown.first(TfminiProtocol::kFrameBytes - 1)) == shown.back() ? ScanVerdict::kFrame
                                                                            : ScanVerdict::kBadChecksum;
}

}  // namespace

void TfminiProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  scanner_.scan(bytes, counters_, [&](std::span<const std::uint8_t> shown) {
    const auto verdict = judgeTfmini(shown);
    if (verdict == ScanVerdict::kFrame) range_.set(decode(shown), received);
    return verdict;
  });
}

TfminiRange TfminiProtocol::decode(std::span<const std::uint8_t> frame) const noexcept {
  const auto distance = readLittleEndian<std::uint16_t>(frame, 2);
  const auto strength = readLittleEndian<std::uint16_t>(frame, 4);
  const auto temperature = readLittleEndian<std::uint16_t>(frame, 6);
  return {.distance_m = static_cast<float>(distance) * metre_per_count_,
          .strength = strength,
          .temperature_c = static_cast<float>(temperature) / 8.0F - 256.0F,
          .valid = strength >= kWeakest && strength != kOverexposed && distance < kFirstErrorDistance};
}

std::size_t TfminiProtocol::pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept {
  const std::size_t length = payload.size() + 3;  // header, length, checksum
  if (payload.empty() || length > kLongestCommand || length > out.size()) return 0;
  out[0] = kCommandHeader;
  out[1] = static_cast<std::uint8_t>(length);
  std::copy(payload.begin(), payload.end(), out.begin() + 2);
  out[length - 1] = sum8(out.first(length - 1));
  return length;
}

}  // namespace rc10
