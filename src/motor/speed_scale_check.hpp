#pragma once

#include "app/time.hpp"
#include "motor/motor_settings.hpp"

namespace rc10 {

/// Comparison of the speed that a drive reports with the change of its angle. Drives of the MIT kind send
/// both as fractions of ranges that differ by model: with those of another model every speed and torque,
/// reported and commanded, is wrong by the same factor. At the output shaft.
///
/// A window is a stretch of motion at a steady speed, long enough for noise, quantisation and time stamps
/// not to matter. Windows with anything else in them (a stop, a turn-around, lost samples, a slip of the
/// angle) are not judged. The first few that say the same decide, until reset().
class SpeedScaleCheck {
 public:
  enum class Verdict : unsigned char { kOpen, kAgrees, kWrong };

  /// `error`: share of the true speed by which the reported one may be higher; 0: nothing is compared.
  explicit SpeedScaleCheck(double error = kScaleError) noexcept : error_(error) {}

  void reset() noexcept { *this = SpeedScaleCheck{error_}; }
  /// A sample. `angle_deg` goes on over turns; a speed that is not reported is NaN.
  void add(MonotonicTime received, double angle_deg, double velocity_rpm) noexcept;
  [[nodiscard]] Verdict verdict() const noexcept { return verdict_; }
  /// Reported speed over true speed; of the last window that was judged.
  [[nodiscard]] double ratio() const noexcept { return ratio_; }

 private:
  struct Sample {
    MonotonicTime received;
    double angle_deg = 0.0;
    double deg_per_s = 0.0;
  };
  void begin(const Sample& sample) noexcept;
  void judge(double ratio) noexcept;

  double error_;
  Verdict verdict_ = Verdict::kOpen;
  double ratio_ = 1.0;
  int agreed_ = 0;
  int wrong_ = 0;  ///< In a row, with about the same ratio.
  bool begun_ = false;
  Sample first_;
  Sample last_;
  double slowest_ = 0.0;  ///< Reported speeds of the window, without sign.
  double fastest_ = 0.0;
  double reported_deg_ = 0.0;  ///< Integral of the reported speed.
  int intervals_ = 0;
};

}  // namespace rc10
