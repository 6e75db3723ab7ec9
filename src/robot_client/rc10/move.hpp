#pragma once

#include <string>

#include "app/time.hpp"
#include "app/units.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

/// Outcome of a moveTo().
struct MoveResult {
  enum class Outcome {
    kDone,     ///< It stands within the tolerance. The target is held on.
    kFailed,   ///< It cannot get there: `reason`. The target is not held any more.
    kTimeout,  ///< It is not there yet. The target is held on: set another, or coast().
  };
  Outcome outcome = Outcome::kFailed;
  std::string reason;      ///< Empty when done.
  double angle_deg = 0.0;  ///< The last known, of the kind that was asked for; NaN: unknown.

  [[nodiscard]] explicit operator bool() const noexcept { return outcome == Outcome::kDone; }
};

}  // namespace robot_client
}  // namespace rc10
