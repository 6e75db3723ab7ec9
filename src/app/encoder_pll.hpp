#pragma once

namespace rc10 {

/// Velocity from a quantised encoder: a phase-locked loop that follows the angle and whose frequency is
/// the velocity. A difference of two samples knows the velocity to one count per dt only; this knows it
/// to about (bandwidth * dt)^2 counts per dt.
///
/// One step is the critically damped tracker with fading memory (E. Brookner, Tracking and Kalman
/// Filtering Made Easy) with both poles at exp(-bandwidth * dt): stable for any bandwidth and dt.
/// The velocity follows like two low-passes of that bandwidth; it lags a steady acceleration a by
/// 2 a / bandwidth, and the angle of a steady velocity has no lag.
///
/// dt of 0, below, or NaN: nothing advances. A sample that is not finite is left out: give the next one
/// the dt since the last good one.
class EncoderPll {
 public:
  struct Config {
    double bandwidth_rad_s = 0.0;  ///< Not above 0: the difference of the samples, unfiltered.
    /// 0: the angle counts turns. 360: it is within a turn, and the way round it is the shortest.
    double circular_period_deg = 0.0;
  };
  struct State {
    double angle_deg = 0.0;
    double velocity_rpm = 0.0;
    bool running = false;  ///< A sample came since reset().
  };

  EncoderPll() = default;
  explicit EncoderPll(const Config& config) noexcept : config_(config) {}

  /// One sample, dt_s after the last. The first only sets the angle.
  const State& step(double measured_deg, float dt_s) noexcept;
  void reset() noexcept { state_ = {}; }

  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  Config config_;
  State state_;
};

}  // namespace rc10
