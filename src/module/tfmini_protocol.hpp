#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/frame_scanner.hpp"
#include "bus/i_protocol.hpp"
#include "module/stamped.hpp"

namespace rc10 {

/// One measurement.
struct TfminiRange {
  float distance_m = 0.0F;     ///< Meaningless unless valid.
  std::uint16_t strength = 0;  ///< Strength of the reflected light.
  float temperature_c =
      0.0F;  ///< Temperature of TFmini-S and TFmini Plus; the first TFmini sends something else here.
  bool valid = false;  ///< Enough light came back, and not too much.
};

/// Benewake's TFmini, TFmini-S and TFmini Plus: 115200 baud 8N1, 100 frames of 9 bytes a second. Source:
/// Benewake, data sheets of TFmini-S (SJ-PM-TFmini-S) and TFmini Plus (SJ-GU).
class TfminiProtocol final : public I_Protocol {
 public:
  static constexpr std::size_t kFrameBytes = 9;

  /// Unit that the sensor is set to; centimetres by default.
  enum class Unit : std::uint8_t { kCentimetre, kMillimetre };

  // Commands for pack_frame(): the first byte of the payload. Settings are lost when the sensor is switched
  // off, unless they are saved.
  static constexpr std::uint8_t kSetRateHz = 0x03;  ///< then a u16, low byte first: 1000 / n
  static constexpr std::uint8_t kSetOutput = 0x05;  ///< then 1: centimetres, 6: millimetres
  static constexpr std::uint8_t kSetBaud = 0x06;    ///< then a u32
  static constexpr std::uint8_t kRestore = 0x10;
  static constexpr std::uint8_t kSave = 0x11;

  explicit TfminiProtocol(Unit unit = Unit::kCentimetre) noexcept
      : metre_per_count_(unit == Unit::kCentimetre ? 0.01F : 0.001F) {}

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// A command: `payload` is its id and its data.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override { scanner_.clear(counters_); }

  /// The latest measurement, valid or not.
  [[nodiscard]] const Stamped<TfminiRange>& range() const noexcept { return range_; }

 private:
  [[nodiscard]] TfminiRange decode(std::span<const std::uint8_t> frame) const noexcept;

  float metre_per_count_;
  FrameScanner<kFrameBytes> scanner_;
  Stamped<TfminiRange> range_;
};

}  // namespace rc10
