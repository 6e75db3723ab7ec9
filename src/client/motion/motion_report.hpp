#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "client/json_line.hpp"
#include "client/motion/frequency_response.hpp"
#include "client/motion/motion_run.hpp"
#include "client/motion/step_response.hpp"

namespace rc10::client {

/// Numbers of a test, for as far as it went.
struct MotionReport {
  std::size_t ticks = 0;
  FollowingError following;  ///< After the lead.
  double largest_velocity_rpm = std::numeric_limits<double>::quiet_NaN();
  double largest_current_a = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t limits = 0;  ///< That acted in any tick after the lead.
  std::optional<StepResponse> step;
  /// Slope of the velocity in a step of the current, once that has risen.
  double acceleration_rpm_per_s = std::numeric_limits<double>::quiet_NaN();
  FrequencyResponse response;  ///< Sweep and multisine: measured value over shaped target.
  double bandwidth_hz = std::numeric_limits<double>::quiet_NaN();
  StabilityMargins margins;
};

[[nodiscard]] MotionReport reportOf(const MotionRun& test);

/// Lines for a person: the numbers, and a Bode table.
[[nodiscard]] std::string text(const MotionReport& report, const MotionRun& test);
[[nodiscard]] Json jsonOf(const MotionReport& report, const MotionRun& test);
/// With a heading; one line for each tick, or each frequency.
[[nodiscard]] std::string curveCsv(const Curve& curve);
[[nodiscard]] std::string bodeCsv(const FrequencyResponse& response);

}  // namespace rc10::client
