#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/time.hpp"

namespace rc10 {

/// Speed of a Damiao drive. Its field wraps at +-v_max, which some models pass without a load: there a shaft
/// that is too fast would seem to turn back, and would be driven on. Neighbouring samples are alike, and over
/// some of them the position says which of the wraps it is. Scheduler thread only.
class DamiaoSpeed {
 public:
  explicit DamiaoSpeed(double v_max_rad_s) noexcept
      : wrap_rad_s_(2.0 * v_max_rad_s * kCodes / (kCodes - 1.0)) {}

  /// As reported, and the position that goes on over turns; `follows`: it does since the sample before.
  double take(double told_rad_s, double position_rad, bool follows, MonotonicTime received) noexcept {
    if (std::exchange(anew_, false) || !follows || received - before_ > kLongestGap) {
      speed_rad_s_ = told_rad_s;
      look(position_rad, received);
    } else {
      speed_rad_s_ = nearest(told_rad_s, speed_rad_s_);
      if (const Duration passed = received - looked_; passed >= kWindow) {
        const double mean_rad_s =
            (position_rad - position_rad_) / std::chrono::duration<double>(passed).count();
        speed_rad_s_ = nearest(told_rad_s, mean_rad_s);
        look(position_rad, received);
      }
    }
    before_ = received;
    return speed_rad_s_;
  }

  /// The position counts from elsewhere from now on.
  void restart() noexcept { anew_ = true; }

 private:
  static constexpr double kCodes = 4096.0;
  // Jitter of the stamps is small beside it, and so is what a shaft gains meanwhile.
  static constexpr Duration kWindow = std::chrono::milliseconds{10};
  static constexpr Duration kLongestGap = std::chrono::milliseconds{100};

  [[nodiscard]] double nearest(double told_rad_s, double to_rad_s) const noexcept {
    return told_rad_s +
           wrap_rad_s_ * std::clamp(std::round((to_rad_s - told_rad_s) / wrap_rad_s_), -1.0, 1.0);
  }
  void look(double position_rad, MonotonicTime now) noexcept {
    position_rad_ = position_rad;
    looked_ = now;
  }

  double wrap_rad_s_;
  bool anew_ = true;
  double speed_rad_s_ = 0.0;
  double position_rad_ = 0.0;
  MonotonicTime looked_{};
  MonotonicTime before_{};
};

}  // namespace rc10
