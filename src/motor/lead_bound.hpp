#pragma once

#include <optional>

#include "app/time.hpp"
#include "motor/spring_law.hpp"

namespace rc10 {

/// Bound of the speed at which a spring leads a shaft to a place: spring and damper balance there. A load
/// needs more of the spring than that, or it sinks for ever. So the bound gives way to what the shaft has to
/// carry, which it finds while it acts: a shaft that is drawn away from the place meets the whole stiffness,
/// one that lags gets more little by little; what makes it too fast is taken back.
class LeadBound {
 public:
  /// Whether it changed the law, whose spring may come to `most_nm`. `limit_rad_s` above 0.
  [[nodiscard]] bool apply(SpringLaw& law, const SpringState& at, double limit_rad_s, double most_nm,
                           MonotonicTime now) noexcept;
  /// No place is followed any more.
  void release() noexcept { *this = {}; }

 private:
  double load_nm_ = 0.0;  ///< Torque against it, so far.
  std::optional<MonotonicTime> last_;
};

}  // namespace rc10
