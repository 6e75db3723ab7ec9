#include "bus/frame_table.hpp"

#include <algorithm>
#include <bit>
#include <string>

namespace rc10 {
namespace {

std::string quoted(const FrameListener& device) { return "'" + std::string(device.name()) + "'"; }

std::uint32_t effectiveMask(const FrameFilter& filter) noexcept {
  return filter.mask & idMask(filter.id.extended);
}

}  // namespace

Result<void> FrameTable::checkFilters(const FrameListener& device) const {
  for (const FrameFilter& filter : device.filters()) {
    if ((filter.id.value & ~idMask(filter.id.extended)) != 0) {
      return fail(quoted(device) + ": " + describe(filter.id) + " is out of range");
    }
    for (const auto& wanted : filter.discriminators) {
      if (!wanted || wanted->byte_index < kMaxPayload) continue;
      return fail(quoted(device) + ": no frame has a payload byte " + std::to_string(wanted->byte_index));
    }
  }
  return {};
}

Result<void> FrameTable::checkAgainst(const FrameListener& device, const Device& other) const {
  if (other.listener == &device) return fail(quoted(device) + " is registered twice");
  if (other.listener->name() == device.name()) {
    return fail("two devices have the name " + quoted(device) + ": rename one of them");
  }
  for (const FrameFilter& a : device.filters()) {
    for (const FrameFilter& b : other.filters) {
      if (!overlaps(a, b)) continue;
      return fail(quoted(device) + " and " + quoted(*other.listener) + " could both accept a frame with " +
                  describe(commonId(a, b)) + ": give one of them another id, or move it to another bus");
    }
  }
  return {};
}

Result<void> FrameTable::checkRoom(const FrameListener& device) const {
  if (size_ >= kMaxDevices) {
    return fail(quoted(device) + ": a bus holds at most " + std::to_string(kMaxDevices) +
                " devices: move it to another bus");
  }
  std::size_t filters = extended_filters_;
  auto masks = masks_;
  std::size_t mask_count = mask_count_;
  for (const FrameFilter& filter : device.filters()) {
    if (!filter.id.extended) continue;
    ++filters;
    const auto end = masks.begin() + static_cast<std::ptrdiff_t>(mask_count);
    if (std::find(masks.begin(), end, effectiveMask(filter)) != end) continue;
    if (mask_count == masks.size()) {
      return fail(quoted(device) + ": a bus holds at most " + std::to_string(kMaxExtendedMasks) +
                  " different masks of extended ids");
    }
    masks[mask_count++] = effectiveMask(filter);
  }
  if (filters > kMaxExtendedFilters) {
    return fail(quoted(device) + ": a bus holds at most " + std::to_string(kMaxExtendedFilters) +
                " filters of extended ids");
  }
  return {};
}

Result<void> FrameTable::add(FrameListener& device) {
  if (auto ok = checkFilters(device); !ok) return ok;
  for (const Device& other : std::span(devices_).first(size_)) {
    if (auto ok = checkAgainst(device, other); !ok) return ok;
  }
  if (auto ok = checkRoom(device); !ok) return ok;

  const DeviceSet self = DeviceSet{1} << size_;
  for (const FrameFilter& filter : device.filters()) {
    if (filter.id.extended) {
      insertExtended(filter, self);
    } else {
      insertStandard(filter, self);
    }
  }
  const auto filters = device.filters();
  const bool by_id = std::none_of(filters.begin(), filters.end(), [](const FrameFilter& filter) {
    return std::any_of(filter.discriminators.begin(), filter.discriminators.end(),
                       [](const auto& wanted) { return wanted.has_value(); });
  });
  devices_[size_++] = {&device, filters, by_id};
  return {};
}

void FrameTable::insertStandard(const FrameFilter& filter, DeviceSet device) noexcept {
  const std::uint32_t mask = effectiveMask(filter);
  for (std::uint32_t id = 0; id <= kStandardIdMask; ++id) {
    if (((id ^ filter.id.value) & mask) == 0) standard_[id] |= device;
  }
}

void FrameTable::insertExtended(const FrameFilter& filter, DeviceSet device) noexcept {
  const std::uint32_t mask = effectiveMask(filter);
  const auto masks = std::span(masks_).first(mask_count_);
  if (std::find(masks.begin(), masks.end(), mask) == masks.end()) masks_[mask_count_++] = mask;
  const std::uint32_t key = filter.id.value & mask;
  Slot& slot = extended_[slotFor(key, mask)];
  slot = {key, mask, slot.devices | device};
  ++extended_filters_;
}

// The slot of the key, or the free one where it belongs.
std::size_t FrameTable::slotFor(std::uint32_t key, std::uint32_t mask) const noexcept {
  constexpr std::uint32_t kGoldenRatio = 0x9E37'79B1U;  // Fibonacci hashing: neighbours spread out
  constexpr int kShift = 32 - std::bit_width(kSlots - 1);
  std::size_t index = ((key ^ std::rotl(mask, 16)) * kGoldenRatio) >> kShift;
  for (;; index = (index + 1) % kSlots) {
    const Slot& slot = extended_[index];
    if (slot.devices == 0 || (slot.key == key && slot.mask == mask)) return index;
  }
}

FrameTable::DeviceSet FrameTable::extendedCandidates(CanId id) const noexcept {
  DeviceSet found = 0;
  for (const std::uint32_t mask : std::span(masks_).first(mask_count_)) {
    found |= extended_[slotFor(id.value & mask, mask)].devices;
  }
  return found;
}

FrameListener* FrameTable::firstOf(DeviceSet candidates, const CanFrame& frame) const noexcept {
  for (DeviceSet left = candidates; left != 0; left &= left - 1) {
    const Device& device = devices_[static_cast<std::size_t>(std::countr_zero(left))];
    if (acceptsAny(device.filters, frame) && device.listener->matchesFrame(frame)) return device.listener;
  }
  return nullptr;
}

FrameListener* FrameTable::find(const CanFrame& frame) const noexcept {
  if (frame.type != FrameType::kData) return nullptr;
  if (frame.id.extended) return firstOf(extendedCandidates(frame.id), frame);
  const DeviceSet candidates = standard_[frame.id.value & kStandardIdMask];
  if (candidates == 0) return nullptr;
  const Device& device = devices_[static_cast<std::size_t>(std::countr_zero(candidates))];
  // The table of standard ids is exact: a filter without a discriminator has nothing to add, and one
  // candidate needs no search.
  const bool decided =
      (candidates & (candidates - 1)) == 0 && device.by_id && frame.id.value <= kStandardIdMask;
  if (!decided) return firstOf(candidates, frame);
  return device.listener->matchesFrame(frame) ? device.listener : nullptr;
}

}  // namespace rc10
