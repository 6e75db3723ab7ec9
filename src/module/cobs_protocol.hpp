#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/i_protocol.hpp"

namespace rc10 {

/// Takes every frame, in order: several may come in one tick.
class CobsListener {
 public:
  CobsListener() = default;
  CobsListener(const CobsListener&) = delete;
  CobsListener& operator=(const CobsListener&) = delete;
  virtual ~CobsListener() = default;
  /// `content`: the frame without its checksum, at least one byte.
  virtual void onFrame(std::span<const std::uint8_t> content, MonotonicTime received) noexcept = 0;
};

/// Binary frames between zeros: content and CRC-16/MODBUS (lowest byte first), stuffed so that no byte of
/// them is 0 (S. Cheshire, M. Baker: Consistent Overhead Byte Stuffing, 1999), then a 0.
class CobsProtocol final : public I_Protocol {
 public:
  static constexpr std::size_t kLongestContent = 128;
  /// Stuffed, with its checksum and the 0. One byte more for each 254.
  static constexpr std::size_t kLongestFrame = kLongestContent + 4;

  /// `listener` outlives the protocol's last parse_stream().
  explicit CobsProtocol(CobsListener& listener) noexcept : listener_(listener) {}

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override;

 private:
  void take(MonotonicTime received) noexcept;

  CobsListener& listener_;
  std::array<std::uint8_t, kLongestFrame> buffer_{};
  std::size_t size_ = 0;  ///< Since the last 0.
  bool too_long_ = false;
  bool seen_delimiter_ = false;  ///< Until then a frame may have begun before the port was opened: no error.
};

}  // namespace rc10
