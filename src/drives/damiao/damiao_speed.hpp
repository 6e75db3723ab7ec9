#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/time.hpp"

namespace rc10 {

/// Speed of a Damiao drive. Its field wraps at +-v_max, which some models pass without a load: there a shaft
/// that is too fast would seem to turn back, and would be driven on. Neighbouring samples are alike, and the
/// way of some of them says which of the wraps it is. Scheduler thread only.
class DamiaoSpeed {
 public:
  explicit DamiaoSpeed(double v_max_rad_s) noexcept
      : wrap_rad_s_(2.0 * v_max_rad_s * kCodes / (kCodes - 1.0)) {}

  /// As reported, and the position that goes on over turns; `follows`: it does since the sample before.
  double take(double told_rad_s, double position_rad, bool follows, MonotonicTime received) noexcept {
    const Duration gap = received - std::exchange(before_, received);
    if (std::exchange(anew_, false) || !follows || gap > kLongestGap) {
      speed_rad_s_ = told_rad_s;
      begin(position_rad, received);
      return speed_rad_s_;
    }
    const double before_rad_s = speed_rad_s_;
    speed_rad_s_ = nearest(told_rad_s, speed_rad_s_);
    explained_rad_ += (before_rad_s + speed_rad_s_) / 2.0 * std::chrono::duration<double>(gap).count();
    if (received - begun_ >= kWindow) {
      const double passed_s = std::chrono::duration<double>(received - begun_).count();
      const double off_rad_s = (position_rad - begun_rad_ - explained_rad_) / passed_s;
      speed_rad_s_ = nearest(told_rad_s, speed_rad_s_ + off_rad_s);
      begin(position_rad, received);
    }
    return speed_rad_s_;
  }
  /// The position counts from elsewhere from now on.
  void restart() noexcept { anew_ = true; }

 private:
  static constexpr double kCodes = 4096.0;
  // A slip of the encoder that DamiaoPosition takes for noise, 0.1 rad, is no wrap over this time.
  static constexpr Duration kWindow = std::chrono::milliseconds{25};
  static constexpr Duration kLongestGap = std::chrono::milliseconds{25};

  [[nodiscard]] double nearest(double told_rad_s, double to_rad_s) const noexcept {
    const double wraps = std::round((to_rad_s - told_rad_s) / wrap_rad_s_);
    return told_rad_s + wrap_rad_s_ * std::clamp(wraps, -1.0, 1.0);
  }
  void begin(double position_rad, MonotonicTime now) noexcept {
    begun_rad_ = position_rad;
    begun_ = now;
    explained_rad_ = 0.0;
  }

  double wrap_rad_s_;
  bool anew_ = true;
  double speed_rad_s_ = 0.0;
  MonotonicTime before_{};
  // First position of the present window, and the way since then by the speeds.
  double begun_rad_ = 0.0;
  MonotonicTime begun_{};
  double explained_rad_ = 0.0;
};

}  // namespace rc10
