#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/i_protocol.hpp"
#include "module/gap_framer.hpp"
#include "module/stamped.hpp"

namespace rc10 {

/// Frame of a DJI DR16 receiver: sticks, switches, mouse and keys.
struct Dr16Input {
  static constexpr int kFullDeflection = 660;

  enum class Switch : std::uint8_t { kUp = 1, kDown = 2, kMiddle = 3 };

  // -660 to 660: right and up are positive.
  std::int16_t right_horizontal = 0;
  std::int16_t right_vertical = 0;
  std::int16_t left_horizontal = 0;
  std::int16_t left_vertical = 0;
  std::int16_t wheel = 0;  ///< The dial; 0 if the remote has none.
  Switch right_switch = Switch::kUp;
  Switch left_switch = Switch::kUp;
  std::int16_t mouse_x = 0;
  std::int16_t mouse_y = 0;
  std::int16_t mouse_z = 0;
  bool mouse_left = false;
  bool mouse_right = false;
  std::uint16_t keys = 0;  ///< From bit 0: W S A D Shift Ctrl Q E R F G Z X C V B

  friend bool operator==(const Dr16Input&, const Dr16Input&) = default;
};

/// DBUS of the DJI DR16: 100000 baud 8E1, inverted, 18 bytes about every 14 ms, with neither header nor
/// checksum: frames are found by the silence between them and by the ranges of their fields. It has no frame
/// for a lost link: some receivers then fall silent and some repeat the last frame, so watch the age of
/// input() (100 ms).
class DbusProtocol final : public I_Protocol {
 public:
  static constexpr std::size_t kFrameBytes = 18;
  static constexpr Duration kGap = std::chrono::milliseconds{3};

  /// `gap`: a silence this long ends a frame. More for an adapter that holds bytes back longer.
  explicit DbusProtocol(Duration gap = kGap) noexcept : framer_(gap) {}

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// A receiver takes no commands: always 0.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override { framer_.restart(counters_); }

  [[nodiscard]] const Stamped<Dr16Input>& input() const noexcept { return input_; }

  /// The frame that a receiver would send; for simulated ones.
  [[nodiscard]] static std::array<std::uint8_t, kFrameBytes> encode(const Dr16Input& input) noexcept;

 private:
  GapFramer<kFrameBytes> framer_;
  Stamped<Dr16Input> input_;
};

}  // namespace rc10
