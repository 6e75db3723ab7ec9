#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/frame_scanner.hpp"
#include "module/imu_protocol.hpp"

namespace rc10 {

/// The binary stream of HiPNUC's sensors (HI226, HI229, HI05, CH0x0, ...) set to packet 0x91: 115200 baud
/// 8N1, 5A A5, length and CRC, little endian. Source: HiPNUC, user manual, "frame of packet 0x91". Frames
/// with other packets count, and bring no values.
class HipnucProtocol final : public ImuProtocol {
 public:
  static constexpr std::size_t kHeaderBytes = 6;
  static constexpr std::size_t kLongestPayload = 256;

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// Commands are lines of text ("LOG VERSION"): `payload` and a line end.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override { scanner_.clear(counters_); }

 private:
  void take(std::span<const std::uint8_t> payload, MonotonicTime received) noexcept;

  FrameScanner<kHeaderBytes + kLongestPayload> scanner_;
};

}  // namespace rc10
