#pragma once

#include <cstdint>
#include <limits>

#include "drives/damiao/damiao_frames.hpp"
#include "motor/lead_bound.hpp"

namespace rc10 {

/// Bounds of a MIT command, at the drive's own output.
struct DamiaoMitBounds {
  DamiaoScale scale;
  double torque_nm = 0.0;
  double velocity_rad_s = 0.0;  ///< 0: none but the scale's.
  SpringState measured;         ///< The position: the drive's own count.
  bool position_known = false;
  double reach_rad =
      std::numeric_limits<double>::infinity();  ///< Bound of targets, beside that of the scale.
  LeadBound* lead = nullptr;                    ///< For a target that is an angle.
  MonotonicTime now{};
  double damping_nms_per_rad =
      0.0;  ///< Least, where there can be no stiffness: a load sinks, and does not fall.
};

/// A MIT command that makes the drive give no more than its bounds by the last measurement. `limits` collects
/// LimitFlags. Whatever is not finite becomes harmless.
[[nodiscard]] SpringLaw boundedMit(SpringLaw law, const DamiaoMitBounds& bounds,
                                   std::uint32_t& limits) noexcept;

}  // namespace rc10
