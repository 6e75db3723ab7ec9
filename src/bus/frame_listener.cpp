#include "bus/frame_listener.hpp"

#include <algorithm>
#include <array>

namespace rc10 {
namespace {

bool exclude(const PayloadDiscriminator& a, const PayloadDiscriminator& b) noexcept {
  return a.byte_index == b.byte_index && ((a.value ^ b.value) & a.mask & b.mask) != 0;
}

bool satisfied(const std::optional<PayloadDiscriminator>& wanted, const CanFrame& frame) noexcept {
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
  const std::array both_a{a.discriminator, a.also};
  const std::array both_b{b.discriminator, b.also};
  return std::none_of(both_a.begin(), both_a.end(), [&both_b](const auto& of_a) {
    return std::any_of(both_b.begin(), both_b.end(),
                       [&of_a](const auto& of_b) { return of_a && of_b && exclude(*of_a, *of_b); });
  });
}

bool accepts(const FrameFilter& filter, const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.id.extended != filter.id.extended) return false;
  const std::uint32_t valid = idMask(filter.id.extended);
  if ((frame.id.value & ~valid) != 0 || ((frame.id.value ^ filter.id.value) & filter.mask & valid) != 0) {
    return false;
  }
  return satisfied(filter.discriminator, frame) && satisfied(filter.also, frame);
}

bool acceptsAny(std::span<const FrameFilter> filters, const CanFrame& frame) noexcept {
  return std::any_of(filters.begin(), filters.end(),
                     [&frame](const FrameFilter& filter) { return accepts(filter, frame); });
}

}  // namespace rc10
