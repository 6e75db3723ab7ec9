#pragma once

namespace rc10 {

/// Longest dt of one step of a controller or generator; a longer one counts as this. After a gap in
/// time a reference must go on from where it was, not jump to where it would be.
inline constexpr float kMaxStepSeconds = 0.1F;

/// Step: at most kMaxStepSeconds. 0 for a dt of 0, below, or NaN: time stands still.
[[nodiscard]] constexpr double stepSeconds(float dt_s) noexcept {
  if (!(dt_s > 0.0F)) return 0.0;
  return static_cast<double>(dt_s < kMaxStepSeconds ? dt_s : kMaxStepSeconds);
}

}  // namespace rc10
