#pragma once

#include <algorithm>
#include <limits>

#include "app/units.hpp"

namespace rc10 {

/// First-order low-pass, implicit Euler: stable and without overshoot for any dt.
///
/// dt of 0, below, or NaN, and input that is not finite: the value stays.
class LowPass {
 public:
  /// `bandwidth_hz` of 0: no filter.
  explicit constexpr LowPass(float bandwidth_hz = 0.0F) noexcept : bandwidth_hz_(bandwidth_hz) {}

  constexpr float step(float input, float dt_s) noexcept {
    if (!(dt_s > 0.0F) || !(input >= -kMost && input <= kMost)) return value_;
    if (!(bandwidth_hz_ > 0.0F)) {
      value_ = input;
      return value_;
    }
    const float x = std::min(static_cast<float>(kRadPerTurn) * bandwidth_hz_ * dt_s, 1e30F);
    value_ += (input - value_) * (x / (1.0F + x));
    return value_;
  }
  constexpr void reset(float value) noexcept { value_ = value; }
  /// From the next step on; the value stays.
  constexpr void setBandwidth(float bandwidth_hz) noexcept { bandwidth_hz_ = bandwidth_hz; }
  [[nodiscard]] constexpr float value() const noexcept { return value_; }

 private:
  static constexpr float kMost = std::numeric_limits<float>::max() / 2.0F;

  float bandwidth_hz_;
  float value_ = 0.0F;
};

}  // namespace rc10
