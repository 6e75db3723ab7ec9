#include "motor/speed_scale_check.hpp"

#include <algorithm>
#include <cmath>

#include "app/units.hpp"

namespace rc10 {
namespace {

// A window. Stamps of bunched frames are some ms off, coarse speeds come in steps of 1 deg/s.
constexpr double kLeastSeconds = 0.1;
constexpr double kLeastDeg = 10.0;
constexpr int kLeastIntervals = 5;
constexpr double kLeastDegPerS = 30.0;
// Fastest over slowest. Faster changes show how late the drive's speed filter is, not its scale.
constexpr double kSteady = 1.2;
constexpr double kLongestGapSeconds = 0.1;
// Between two samples: what an encoder's noise and a backlash add, and how much faster than reported it may
// be.
constexpr double kSlackDeg = 3.0;
constexpr double kMostRatio = 5.0;
constexpr int kWindows = 3;
constexpr double kSameRatio = 1.15;

[[nodiscard]] bool within(double a, double b, double factor) noexcept {
  return a <= b * factor && b <= a * factor;
}

}  // namespace

void SpeedScaleCheck::begin(const Sample& sample) noexcept {
  begun_ = true;
  first_ = last_ = sample;
  slowest_ = fastest_ = std::abs(sample.deg_per_s);
  reported_deg_ = 0.0;
  intervals_ = 0;
}

void SpeedScaleCheck::add(MonotonicTime received, double angle_deg, double velocity_rpm) noexcept {
  if (verdict_ != Verdict::kOpen || !(error_ > 0.0)) return;
  const Sample sample{received, angle_deg, velocity_rpm * kDegPerSPerRpm};
  const double speed = std::abs(sample.deg_per_s);
  if (!(speed >= kLeastDegPerS) || !std::isfinite(speed) || !std::isfinite(angle_deg)) {
    begun_ = false;
    return;
  }
  if (!begun_) return begin(sample);
  const double dt_s = std::chrono::duration<double>(received - last_.received).count();
  const double moved_deg = angle_deg - last_.angle_deg;
  slowest_ = std::min(slowest_, speed);
  fastest_ = std::max(fastest_, speed);
  const bool one_motion = sample.deg_per_s * last_.deg_per_s > 0.0 && dt_s >= 0.0 &&
                          dt_s <= kLongestGapSeconds && fastest_ <= kSteady * slowest_ &&
                          std::abs(moved_deg) <= kSlackDeg + kMostRatio * speed * dt_s;
  if (!one_motion) return begin(sample);
  reported_deg_ += 0.5 * (sample.deg_per_s + last_.deg_per_s) * dt_s;
  last_ = sample;
  ++intervals_;
  const double turned_deg = angle_deg - first_.angle_deg;
  const double lasted_s = std::chrono::duration<double>(received - first_.received).count();
  const double least_deg = std::min(std::abs(turned_deg), std::abs(reported_deg_));
  const double most_deg = std::max(std::abs(turned_deg), std::abs(reported_deg_));
  if (lasted_s < kLeastSeconds || most_deg < kLeastDeg || intervals_ < kLeastIntervals) return;
  // The end of a position scale, or a reversed sign: not a matter of scales.
  const bool judged = least_deg * kMostRatio >= most_deg && turned_deg * reported_deg_ > 0.0;
  const double ratio = judged ? reported_deg_ / turned_deg : 0.0;
  begin(sample);
  if (judged) judge(ratio);
}

void SpeedScaleCheck::judge(double ratio) noexcept {
  if (within(ratio, 1.0, 1.0 + error_)) {
    wrong_ = 0;
    if (++agreed_ >= kWindows) verdict_ = Verdict::kAgrees;
  } else {
    wrong_ = wrong_ > 0 && within(ratio, ratio_, kSameRatio) ? wrong_ + 1 : 1;
    if (wrong_ >= kWindows) verdict_ = Verdict::kWrong;
  }
  ratio_ = ratio;
}

}  // namespace rc10
