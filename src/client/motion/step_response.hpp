#pragma once

#include <limits>
#include <span>

namespace rc10::client {

/// Numbers of a step response, those of Python's rc10.step. NaN: it never got there.
struct StepResponse {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double rise_s = kUnknown;             ///< From 10 to 90 % of the step.
  double overshoot_percent = kUnknown;  ///< Beyond the target, of the step.
  double peak = kUnknown;
  double peak_s = kUnknown;
  double settling_s = kUnknown;    ///< From then on within 2 % of the step around the target.
  double steady_error = kUnknown;  ///< Target less the mean of the last fifth.
};

/// The step from `start` to `target` happens at time 0; what is before is not looked at. Times ascend.
[[nodiscard]] StepResponse judgeStep(std::span<const double> time_s, std::span<const double> response,
                                     double start, double target);

/// Error of target less response; NaN samples are left out.
struct FollowingError {
  double rms = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();  ///< The largest magnitude.
};
[[nodiscard]] FollowingError followingError(std::span<const double> target, std::span<const double> response);

}  // namespace rc10::client
