#pragma once

#include <cmath>
#include <limits>
#include <optional>

namespace rc10 {

/// Where an output shaft may stand: its soft limits. Infinite: none.
struct Travel {
  double min_deg = -std::numeric_limits<double>::infinity();
  double max_deg = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool bothEnds() const noexcept { return std::isfinite(min_deg) && std::isfinite(max_deg); }
};

/// The total angle of an encoder that tells the angle of the output shaft within one turn. Without both
/// limits within half a turn of `near_deg`, as such a shaft has no wrong turn: 0 at power-up, later the angle
/// of before, so that a stream of targets goes on where it was. With both the turn on which the shaft is
/// nearest to its travel: half the gap that the travel leaves of a turn belongs to each end, so an arm that
/// sags past its limit is still on its turn. None near the middle of the gap, where noise would decide, and
/// where the travel is a turn or more.
[[nodiscard]] std::optional<double> firstAngle(double within_turn_deg, const Travel& travel,
                                               double near_deg = 0.0) noexcept;

}  // namespace rc10
