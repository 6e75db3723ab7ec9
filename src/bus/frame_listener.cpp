#include "bus/frame_listener.hpp"

#include <algorithm>
#include <array>

namespace rc10 {
namespace {

using Wanted = std::optional<PayloadDiscriminator>;

bool exclude(const Wanted& a, const Wanted& b) noexcept {
  return a && b && a->byte_index == b->byte_index && ((a->value ^ b->value) & a->mask & b->mask) != 0;
}

bool satisfied(const Wanted& wanted, const CanFrame& frame) noexcept {
  if (!wanted) return true;
  const auto& [byte_index, mask, value] = *wanted;
  return byte_index < frame.length && byte_index < kMaxPayload &&
         ((frame.data[byte_index] ^ value) & mask) == 0;
}

}  // namespace

bool overlaps(const FrameFilter& a, const FrameFilter& b) noexcept {
  if (a.id.extended != b.id.extended) return false;
  const std::uint32_t common = a.mask & b.mask & idMask(a.id.extended);
  if (((a.id.value ^ b.id.value) & common) != 0) return false;
  // Those of one filter as well: one that contradicts itself accepts no frame.
  const std::array all{a.discriminators[0], a.discriminators[1], b.discriminators[0], b.discriminators[1]};
  return std::none_of(all.begin(), all.end(), [&all](const Wanted& one) {
    return std::any_of(all.begin(), all.end(), [&one](const Wanted& other) { return exclude(one, other); });
  });
}

CanId commonId(const FrameFilter& a, const FrameFilter& b) noexcept {
  const std::uint32_t value = (a.id.value & a.mask) | (b.id.value & b.mask);
  return {value & idMask(a.id.extended), a.id.extended};
}

bool accepts(const FrameFilter& filter, const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.id.extended != filter.id.extended) return false;
  const std::uint32_t valid = idMask(filter.id.extended);
  if ((frame.id.value & ~valid) != 0 || ((frame.id.value ^ filter.id.value) & filter.mask & valid) != 0) {
    return false;
  }
  return std::all_of(filter.discriminators.begin(), filter.discriminators.end(),
                     [&frame](const Wanted& wanted) { return satisfied(wanted, frame); });
}

bool acceptsAny(std::span<const FrameFilter> filters, const CanFrame& frame) noexcept {
  return std::any_of(filters.begin(), filters.end(),
                     [&frame](const FrameFilter& filter) { return accepts(filter, frame); });
}

}  // namespace rc10
