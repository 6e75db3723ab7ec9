#include "bus/frame_listener.hpp"

#include <algorithm>

namespace rc10 {
namespace {

bool exclude(const PayloadDiscriminator& a, const PayloadDiscriminator& b) noexcept {
  return a.byte_index == b.byte_index && ((a.value ^ b.value) & a.mask & b.mask) != 0;
}

}  // namespace

bool overlaps(const FrameFilter& a, const FrameFilter& b) noexcept {
  if (a.id.extended != b.id.extended) return false;
  const std::uint32_t common = a.mask & b.mask & idMask(a.id.extended);
  if (((a.id.value ^ b.id.value) & common) != 0) return false;
  return !(a.discriminator && b.discriminator && exclude(*a.discriminator, *b.discriminator));
}

bool accepts(const FrameFilter& filter, const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.id.extended != filter.id.extended) return false;
  const std::uint32_t valid = idMask(filter.id.extended);
  if ((frame.id.value & ~valid) != 0 || ((frame.id.value ^ filter.id.value) & filter.mask & valid) != 0) {
    return false;
  }
  if (!filter.discriminator) return true;
  const auto& [byte_index, mask, value] = *filter.discriminator;
  return byte_index < frame.length && byte_index < kMaxPayload &&
         ((frame.data[byte_index] ^ value) & mask) == 0;
}

bool acceptsAny(std::span<const FrameFilter> filters, const CanFrame& frame) noexcept {
  return std::any_of(filters.begin(), filters.end(),
                     [&frame](const FrameFilter& filter) { return accepts(filter, frame); });
}

}  // namespace rc10
