#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/frame_scanner.hpp"
#include "module/imu_protocol.hpp"

namespace rc10 {

/// The stream of WitMotion's TTL and USB sensors (WT61, WT901, HWT905, ...): 9600 baud 8N1 by default,
/// packets of 11 bytes, one for each quantity. Source: docs.wit-motion.com, HWT905-TTL, "Protocol".
class WitMotionProtocol final : public ImuProtocol {
 public:
  static constexpr std::size_t kFrameBytes = 11;

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// Register writes: `payload` is the register and two bytes of data, the frame FF AA register low high.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override { scanner_.clear(counters_); }

 private:
  void take(std::span<const std::uint8_t> frame, MonotonicTime received) noexcept;

  FrameScanner<kFrameBytes> scanner_;
};

}  // namespace rc10
