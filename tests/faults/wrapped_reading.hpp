#pragma once

#include <chrono>
#include <cmath>

#include "motor/wrapped_speed.hpp"

namespace rc10::test {

/// Speed of a drive whose fields of position and speed both go round at their ends. A wrong wrap is not seen
/// with it: it takes the class of the motors, and readings are compared modulo a wrap (wrapped_speed_test
/// and overspeed_test do see it).
class WrappedReading {
 public:
  /// `field_rad`: from one end of the position's field to the other. `fastest_rad_s`: see WrappedSpeed.
  WrappedReading(double field_rad, double v_max_rad_s, double fastest_rad_s) noexcept
      : field_rad_(field_rad), fastest_rad_s_(fastest_rad_s), speed_(v_max_rad_s, fastest_rad_s) {}

  double take(double told_rad_s, double position_rad, MonotonicTime received) noexcept {
    const auto gap = received - received_;
    const double step_rad = std::remainder(position_rad - position_rad_, field_rad_);
    const double most_rad = fastest_rad_s_ * std::chrono::duration<double>(gap).count() + kSlipRad;
    const bool follows = gap <= kLongestGap && std::fabs(step_rad) <= most_rad;
    way_rad_ += step_rad;
    position_rad_ = position_rad;
    received_ = received;
    return speed_.take(told_rad_s, way_rad_, follows, received);
  }

 private:
  // More, and the drive may have been restarted.
  static constexpr Duration kLongestGap = std::chrono::milliseconds{100};
  // Beside what the fastest shaft turns: an encoder whose fault begins or ends is elsewhere at once.
  static constexpr double kSlipRad = 1.0;

  double field_rad_;
  double fastest_rad_s_;
  WrappedSpeed speed_;
  double position_rad_ = 0.0;
  double way_rad_ = 0.0;
  MonotonicTime received_{};
};

}  // namespace rc10::test
