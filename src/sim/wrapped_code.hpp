#pragma once

#include <cstdint>

namespace rc10::sim {

/// From -limit to limit as a number of `bits`, truncated: what does not fit wraps, as in firmware that
/// scales without limits.
[[nodiscard]] inline std::uint16_t wrappedCode(double value, double limit, unsigned bits) noexcept {
  const double full = static_cast<double>((1U << bits) - 1U);
  const auto code = static_cast<std::int64_t>((value + limit) * full / (2.0 * limit));
  return static_cast<std::uint16_t>(static_cast<std::uint64_t>(code) & ((1U << bits) - 1U));
}

}  // namespace rc10::sim
