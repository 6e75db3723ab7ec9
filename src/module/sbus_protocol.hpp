#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/i_protocol.hpp"
#include "module/gap_framer.hpp"
#include "module/stamped.hpp"

namespace rc10 {

/// One SBUS frame.
struct SbusInput {
  static constexpr std::size_t kChannels = 16;
  static constexpr int kCentre = 992;
  static constexpr int kFullDeflection = 820;  ///< Usual travel: 172 to 1812.

  std::array<std::uint16_t, kChannels> raw{};  ///< 0 to 2047
  std::array<bool, 2> digital{};               ///< Channels 17 and 18
  bool frame_lost = false;  ///< The receiver missed a frame of its remote: the channels are old.
  bool failsafe = false;    ///< The receiver has lost its remote: the channels mean nothing.

  /// -1 to 1; `channel` from 0.
  [[nodiscard]] float deflection(std::size_t channel) const noexcept;
  /// As the pulse of a servo.
  [[nodiscard]] float pulseUs(std::size_t channel) const noexcept {
    return 0.625F * static_cast<float>(raw[channel]) + 880.0F;
  }

  friend bool operator==(const SbusInput&, const SbusInput&) = default;
};

/// SBUS of Futaba and many others: 100000 baud 8E2, inverted, 25 bytes every 7 to 14 ms. It has no checksum:
/// frames are found by the silence between them, header, end byte and the unused bits.
class SbusProtocol final : public I_Protocol {
 public:
  static constexpr std::size_t kFrameBytes = 25;
  static constexpr Duration kGap = std::chrono::milliseconds{2};  // of 4 ms or more

  /// `gap`: a silence this long ends a frame.
  explicit SbusProtocol(Duration gap = kGap) noexcept : framer_(gap) {}

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// A receiver takes no commands: always 0.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override { framer_.restart(counters_); }

  /// The latest frame, also with its flags set: look at them before the channels.
  [[nodiscard]] const Stamped<SbusInput>& input() const noexcept { return input_; }

  /// The frame that a receiver would send; for simulated ones.
  [[nodiscard]] static std::array<std::uint8_t, kFrameBytes> encode(const SbusInput& input) noexcept;

 private:
  GapFramer<kFrameBytes> framer_;
  Stamped<SbusInput> input_;
};

}  // namespace rc10
