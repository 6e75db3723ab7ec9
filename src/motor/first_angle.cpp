#include "motor/first_angle.hpp"

#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"

namespace rc10 {
namespace {

// Backlash and quantisation of an output encoder stay below.
constexpr double kDoubtDeg = 1.0;

}  // namespace

std::optional<double> firstAngle(double within_turn_deg, const Travel& travel, double near_deg) noexcept {
  if (!travel.bothEnds()) return near_deg + shortestAngle(near_deg, within_turn_deg);
  if (!(travel.max_deg - travel.min_deg < kDegPerTurn)) return std::nullopt;
  const double middle_deg = 0.5 * travel.min_deg + 0.5 * travel.max_deg;
  const double from_middle_deg = shortestAngle(middle_deg, within_turn_deg);
  if (kDegPerTurn / 2 - std::fabs(from_middle_deg) < kDoubtDeg) return std::nullopt;
  return middle_deg + from_middle_deg;
}

}  // namespace rc10
