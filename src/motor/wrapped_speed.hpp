#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/time.hpp"

namespace rc10 {

/// Times the no-load speed up to which wraps are followed: a full battery, a load that drives. More than the
/// default of overspeed_rpm.
inline constexpr double kWrapReach = 1.7;

/// Speed of a drive whose field of 12 bits wraps at +-v_max (Damiao, CubeMars mit), which some models pass
/// without a load: there a shaft that is too fast would seem to turn back, and would be driven on. The way
/// since the samples before says which of the wraps it is. A field that is cut off instead stays as it is
/// told. Scheduler thread only.
class WrappedSpeed {
 public:
  /// `fastest_rad_s`: end of the speeds to which wraps are followed; at most `v_max_rad_s`: none is.
  WrappedSpeed(double v_max_rad_s, double fastest_rad_s) noexcept
      : wrap_rad_s_(2.0 * v_max_rad_s * kCodes / (kCodes - 1.0)), fastest_rad_s_(fastest_rad_s) {}

  /// Speed, rad/s, from the told one and the position over turns; `follows`: it continues that of the sample
  /// before.
  double take(double told_rad_s, double position_rad, bool follows, MonotonicTime received) noexcept {
    const Duration gap = received - std::exchange(before_, received);
    const double moved_rad = position_rad - std::exchange(before_rad_, position_rad);
    if (std::exchange(anew_, false) || !follows) {
      speed_rad_s_ = told_rad_s;
      begin(position_rad, received);
      return speed_rad_s_;
    }
    const double gap_s = std::chrono::duration<double>(gap).count();
    const double before_rad_s = speed_rad_s_;
    // Over a short time stamps jitter, and a shaft gains little.
    speed_rad_s_ = nearest(told_rad_s, gap > kShort ? moved_rad / gap_s : before_rad_s);
    explained_rad_ += (before_rad_s + speed_rad_s_) / 2.0 * gap_s;
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
  // A slip of the encoder by 0.1 rad is no wrap over this time.
  static constexpr Duration kWindow = std::chrono::milliseconds{25};
  static constexpr Duration kShort = std::chrono::milliseconds{3};

  [[nodiscard]] double nearest(double told_rad_s, double to_rad_s) const noexcept {
    const double least = std::min(std::ceil((-fastest_rad_s_ - told_rad_s) / wrap_rad_s_), 0.0);
    const double most = std::max(std::floor((fastest_rad_s_ - told_rad_s) / wrap_rad_s_), 0.0);
    return told_rad_s +
           wrap_rad_s_ * std::clamp(std::round((to_rad_s - told_rad_s) / wrap_rad_s_), least, most);
  }
  void begin(double position_rad, MonotonicTime now) noexcept {
    begun_rad_ = position_rad;
    begun_ = now;
    explained_rad_ = 0.0;
  }

  double wrap_rad_s_;
  double fastest_rad_s_;
  bool anew_ = true;
  double speed_rad_s_ = 0.0;
  MonotonicTime before_{};
  double before_rad_ = 0.0;
  // First position of the present window, and the way since then by the speeds.
  double begun_rad_ = 0.0;
  MonotonicTime begun_{};
  double explained_rad_ = 0.0;
};

}  // namespace rc10
