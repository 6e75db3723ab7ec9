#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/time.hpp"
#include "app/wheel_speeds.hpp"
#include "module/module_base.hpp"

namespace rc10 {

/// Between two samples no motor turns this many times faster than it can be told to: an angle that has jumped
/// (a new reference, a restarted drive) is no way that was travelled.
inline constexpr double kImpossibleSpeed = 3.0;

/// Way of motors from sample to sample: of wheels, of a feeder. Samples come when they come, or are lost: the
/// whole way since the last one counts in the tick of the next.
class TravelOfMotors {
 public:
  /// limit_rpm: no motor is told to turn faster.
  TravelOfMotors(std::size_t motors, double limit_rpm) : last_(motors), limit_rpm_(limit_rpm) {}

  /// Way since the sample of the last call, as a mean speed over dt; 0 without a new one. Where the angle is
  /// not known, has jumped or is at the end of the drive's field: by the measured velocity.
  [[nodiscard]] double meanRpm(std::size_t motor, const MotorFeedback& feedback, float dt_s) noexcept {
    const Sample last = last_[motor];
    if (feedback.samples == last.samples) return 0.0;
    last_[motor] = {feedback.total_angle_deg, feedback.received, feedback.samples};
    // Stamps jitter: two samples of one tick may lie closer together than the drive took them.
    const float between_s =
        last.samples == 0 ? dt_s : std::max(dt_s, seconds(feedback.received - last.received));
    const double share = static_cast<double>(between_s) / static_cast<double>(dt_s);
    const double rpm = rc10::meanRpm(last.angle_deg, feedback.total_angle_deg, between_s);
    const bool possible =
        std::isfinite(rpm) && !feedback.angle_at_end && std::fabs(rpm) <= kImpossibleSpeed * limit_rpm_;
    // After a long silence the present velocity says nothing about the time before.
    return possible ? rpm * share : static_cast<double>(feedback.velocity_rpm) * std::min(share, kMostTicks);
  }

 private:
  struct Sample {
    double angle_deg = kNoSignal;
    MonotonicTime received{};
    std::uint64_t samples = 0;
  };
  static constexpr double kMostTicks = 10.0;

  std::vector<Sample> last_;
  double limit_rpm_;
};

}  // namespace rc10
