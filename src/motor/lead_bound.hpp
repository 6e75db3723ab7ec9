#pragma once

#include <optional>

#include "app/time.hpp"
#include "motor/spring_law.hpp"

namespace rc10 {

/// Bound of the speed at which a spring leads a shaft to a place: spring and damper balance there. A load
/// needs more of the spring than that, or it sinks for ever. So the bound gives way to what the shaft has to
/// carry, which is what spring and damper balance while it does not accelerate. A shaft that is drawn away
/// meets the whole stiffness, one that stands gets more little by little; one that was let go, less at once.
class LeadBound {
 public:
  /// Whether it changed the law, whose spring may come to `most_nm`. `limit_rad_s` above 0.
  [[nodiscard]] bool apply(SpringLaw& law, const SpringState& at, double limit_rad_s, double most_nm,
                           MonotonicTime now) noexcept;
  /// Before a stop: of what stands at its limit, against a shaft with less than half of the limit of the
  /// speed, the part stays that it carried while it last moved. Below the limit, a push cannot be told from a
  /// load.
  void dropWindup(double velocity_rad_s, double limit_rad_s, double most_nm) noexcept;
  /// No place is followed any more.
  void release() noexcept { *this = {}; }

 private:
  [[nodiscard]] bool woundUp(double most_nm) const noexcept;
  void estimate(const SpringLaw& law, const SpringState& at, double limit_rad_s, double most_nm,
                double step_s) noexcept;
  [[nodiscard]] bool letGo(double velocity_rad_s, double limit_rad_s, double damping_nms_per_rad,
                           double step_s) noexcept;

  double load_nm_ = 0.0;     ///< Torque against it, so far.
  double carried_nm_ = 0.0;  ///< The same when it last moved: what came since is a hand, or a stop.
  double asks_ = 0.0;        ///< +1 or -1: side on which the last place was too far; 0: none was.
  double stood_s_ = 0.0;     ///< Time that it stood since it last moved along.
  double moved_s_ = 0.0;     ///< Time that it has moved since it last stood.
  std::optional<MonotonicTime> last_;
};

}  // namespace rc10
