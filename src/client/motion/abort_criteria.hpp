#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/vocabulary.hpp"
#include "client/motion/curve.hpp"
#include "client/motion/excitation.hpp"

namespace rc10::client {

/// Bounds of a test, set before it begins. Angles count from where the motor stands then.
struct AbortCriteria {
  double angle_min_deg = -std::numeric_limits<double>::infinity();
  double angle_max_deg = std::numeric_limits<double>::infinity();
  double velocity_max_rpm = std::numeric_limits<double>::infinity();
  double current_max_a = 0.0;
  double feedback_age_max_us = 200'000.0;
  bool limits_abort = false;  ///< A limit that acts ends the test: beyond it nothing is linear.
};

enum class Criterion : std::uint8_t {
  kAngle,
  kVelocity,
  kCurrent,
  kFeedbackAge,
  kLimit,
  kOwnership,  ///< The target in force is not the test's.
  kStatus,     ///< The motor or the robot does not obey.
  kConnection,
  kInterrupted,
  kSilence,  ///< Nobody has said for its time that the test may go on.
};

/// "angle", "velocity", "current", "feedback_age", "limit", "ownership", "status", "connection",
/// "interrupted", "silence"
[[nodiscard]] const char* toString(Criterion criterion) noexcept;

/// End of a test before its time.
struct Abort {
  Criterion criterion{};
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the criterion has no number.
  double limit = std::numeric_limits<double>::quiet_NaN();
  const char* unit = "";
  std::string text;  ///< Cause and remedy.
};

/// Reason why this test must not begin: its target alone would leave the bounds, or a bound is none.
[[nodiscard]] Result<void> admits(const AbortCriteria& criteria, const Excitation& excitation,
                                  ControlMode mode);

/// The first criterion that a sample does not meet; `start_deg`: where the motor stood.
[[nodiscard]] std::optional<Abort> judge(const AbortCriteria& criteria, const CurveSample& sample,
                                         double start_deg);

}  // namespace rc10::client
