#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "bus/can_frame.hpp"

namespace rc10 {

/// One byte of the payload that tells apart devices that share an id, or the commands of one: Damiao drives
/// on one master id differ in the low nibble of byte 0.
struct PayloadDiscriminator {
  std::uint8_t byte_index = 0;
  std::uint8_t mask = 0xFF;
  std::uint8_t value = 0;
};

/// A set of data frames a device listens to: `(frame.id & mask) == (id & mask)` among the standard or
/// the extended ids, and all discriminators that there are: a payload too short to have such a byte is not
/// in the set. Remote and error frames belong to no device.
struct FrameFilter {
  CanId id;
  std::uint32_t mask = kExtendedIdMask;  ///< RobStride carries the motor id inside a varying extended id.
  std::array<std::optional<PayloadDiscriminator>, 2> discriminators{};
};

/// True if some frame could satisfy both filters.
[[nodiscard]] bool overlaps(const FrameFilter& a, const FrameFilter& b) noexcept;

/// The lowest id that satisfies both filters of a pair that overlaps().
[[nodiscard]] CanId commonId(const FrameFilter& a, const FrameFilter& b) noexcept;

/// True if the frame satisfies the filter.
[[nodiscard]] bool accepts(const FrameFilter& filter, const CanFrame& frame) noexcept;
/// True if it satisfies one of them. Not inlined: few frames need it.
[[nodiscard, gnu::noinline]] bool acceptsAny(std::span<const FrameFilter> filters,
                                             const CanFrame& frame) noexcept;

enum class FrameVerdict : std::uint8_t {
  kAccepted,
  kMalformed,  ///< Right id, but a wrong length or content: ignored and counted.
  kForeign,    ///< To its drive, from somebody else: of drives that answer on the id of their commands.
};

/// The receiving half of a device on a bus. Scheduler thread only.
class FrameListener {
 public:
  FrameListener() = default;
  FrameListener(const FrameListener&) = delete;
  FrameListener& operator=(const FrameListener&) = delete;
  virtual ~FrameListener() = default;

  /// For messages: the configured name.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  /// Every frame this device may accept. Constant after construction.
  [[nodiscard]] virtual std::span<const FrameFilter> filters() const noexcept = 0;

  /// Does this frame belong to this device? Asked only for frames that satisfy one of its filters.
  [[nodiscard]] virtual bool matchesFrame(const CanFrame& frame) const noexcept = 0;

  /// Decodes a frame for which matchesFrame() was true.
  virtual FrameVerdict updateFeedback(const CanFrame& frame) noexcept = 0;
};

}  // namespace rc10
