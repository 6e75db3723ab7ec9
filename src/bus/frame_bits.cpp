#include "bus/frame_bits.hpp"

#include <cassert>

namespace rc10 {
namespace {

std::uint64_t nanoseconds(std::uint64_t bits, std::uint64_t rate_bps) noexcept {
  return (bits * 1'000'000'000U + rate_bps - 1) / rate_bps;
}

}  // namespace

Duration frameTime(FrameBits bits, BitRates rates) noexcept {
  assert(rates.nominal_bps > 0);
  if (bits.data == 0 || rates.data_bps == 0) {
    return Duration{nanoseconds(bits.total(), rates.nominal_bps)};
  }
  return Duration{nanoseconds(bits.nominal, rates.nominal_bps) + nanoseconds(bits.data, rates.data_bps)};
}

}  // namespace rc10
