#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "app/result.hpp"
#include "bus/can_frame.hpp"
#include "bus/frame_listener.hpp"

namespace rc10 {

/// Finds the device a frame belongs to, in a time that does not grow with the number of devices.
///
/// A set of devices is one word. Standard ids index it directly; extended ids are hashed once for each
/// different mask in use, of which a bus has one or two. Filters and matchesFrame() confirm.
/// Nothing is allocated except in messages.
class FrameTable {
 public:
  static constexpr std::size_t kMaxDevices = 32;
  static constexpr std::size_t kMaxExtendedFilters = 512;
  static constexpr std::size_t kMaxExtendedMasks = 16;

  /// Refused if it has the name of another device, if both could accept one frame, or if a filter is
  /// impossible. The table is then unchanged. The device outlives the table.
  [[nodiscard]] Result<void> add(FrameListener& device);

  /// nullptr: the frame belongs to no device.
  [[nodiscard]] FrameListener* find(const CanFrame& frame) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  using DeviceSet = std::uint32_t;
  static_assert(kMaxDevices <= 32);

  struct Device {
    FrameListener* listener = nullptr;
    std::span<const FrameFilter> filters;
    bool by_id = true;  ///< No filter looks at the payload.
  };
  struct Slot {
    std::uint32_t key = 0;  // id & mask
    std::uint32_t mask = 0;
    DeviceSet devices = 0;  // 0: a free slot
  };
  static constexpr std::size_t kSlots = 2 * kMaxExtendedFilters;  // at most half full: probes stay short

  [[nodiscard]] Result<void> checkFilters(const FrameListener& device) const;
  [[nodiscard]] Result<void> checkAgainst(const FrameListener& device, const Device& other) const;
  [[nodiscard]] Result<void> checkRoom(const FrameListener& device) const;
  void insertStandard(const FrameFilter& filter, DeviceSet device) noexcept;
  void insertExtended(const FrameFilter& filter, DeviceSet device) noexcept;
  [[nodiscard]] std::size_t slotFor(std::uint32_t key, std::uint32_t mask) const noexcept;
  [[nodiscard]] DeviceSet extendedCandidates(CanId id) const noexcept;
  /// Not inlined: find() is short where a standard id says all.
  [[nodiscard, gnu::noinline]] FrameListener* firstOf(DeviceSet candidates,
                                                      const CanFrame& frame) const noexcept;

  std::array<Device, kMaxDevices> devices_{};
  std::size_t size_ = 0;
  std::array<DeviceSet, kStandardIdMask + 1> standard_{};
  std::array<Slot, kSlots> extended_{};
  std::size_t extended_filters_ = 0;
  std::array<std::uint32_t, kMaxExtendedMasks> masks_{};
  std::size_t mask_count_ = 0;
};

}  // namespace rc10
