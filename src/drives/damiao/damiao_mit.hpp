#pragma once

#include <cstdint>

#include "drives/damiao/damiao_frames.hpp"

namespace rc10 {

/// Bounds of a MIT command, at the drive's own output.
struct DamiaoMitBounds {
  DamiaoScale scale;
  double torque_nm = 0.0;
  double velocity_rad_s = 0.0;  ///< 0: none but the scale's.
  double position_rad = 0.0;    ///< As measured: the drive's own count.
  double measured_rad_s = 0.0;
  bool position_known = false;
};

/// A MIT command that makes the drive give no more than its bounds by the last measurement. The drive itself
/// adds up stiffness, damping and torque without any limit but its current, so the errors that it is to see
/// are made small enough here. `limits` collects LimitFlags. Whatever is not finite becomes harmless.
[[nodiscard]] damiao::MitCommand boundedMit(damiao::MitCommand wanted, const DamiaoMitBounds& bounds,
                                            std::uint32_t& limits) noexcept;

/// The torque that the drive makes of a command.
[[nodiscard]] double mitTorqueNm(const damiao::MitCommand& command, const DamiaoMitBounds& bounds) noexcept;

}  // namespace rc10
