#pragma once

namespace rc10 {

/// The core of filters with two poles: a state-variable filter of two trapezoidal integrators (V.
/// Zavalishin, The Art of VA Filter Design). At a constant rate it is exactly the biquad of
/// the bilinear transform, with the frequency in the right place; unlike a biquad it holds the values of
/// the integrators, so a sample that comes late or is left out does no harm.
class TwoPoleFilter {
 public:
  /// Largest ratio of cut-off frequency to sample rate: the design degenerates near one half.
  static constexpr double kMostOfRate = 0.45;

  /// The filter has settled on this input.
  void settle(double input) noexcept;
  /// `per_sample` = frequency * dt in (0, kMostOfRate], `damping` = 1 / Q.
  void step(double input, double per_sample, double damping) noexcept;

  [[nodiscard]] double highPass() const noexcept { return high_; }
  [[nodiscard]] double lowPass() const noexcept { return low_; }

 private:
  double high_ = 0.0;
  double band_ = 0.0;
  double low_ = 0.0;
  // The tangent is the dearest part, and dt mostly stays.
  double per_sample_ = 0.0;
  double gain_ = 0.0;
};

/// Second-order low-pass of Butterworth: flat below the cut-off, -3 dB at it, -40 dB per decade above.
///
/// It begins settled on its first input. A cut-off that is not above 0: no filter. A cut-off above 0.45
/// of the sample rate counts as that. dt of 0, below, or NaN, and input that is not finite: the last
/// output.
class ButterworthLowPass {
 public:
  explicit ButterworthLowPass(double cutoff_hz = 0.0) noexcept : cutoff_hz_(cutoff_hz) {}

  double step(double input, float dt_s) noexcept;
  /// Settled on this value.
  void reset(double value) noexcept;
  /// As new: settles on the next input.
  void reset() noexcept { started_ = false; }
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  double cutoff_hz_;
  double value_ = 0.0;
  bool started_ = false;
  TwoPoleFilter filter_;
};

/// Takes one frequency out and leaves the others: gain 0 at the centre, -3 dB at the edges of the
/// width, 1 far away from it. For a resonance of the mechanics.
///
/// It begins settled on its first input. A centre or width that is not above 0, or a centre above 0.45
/// of the sample rate: no filter. dt of 0, below, or NaN, and input that is not finite: the last output.
class Notch {
 public:
  struct Config {
    double centre_hz = 0.0;
    double width_hz = 0.0;  ///< Between the -3 dB edges.
  };

  Notch() = default;
  explicit Notch(const Config& config) noexcept : config_(config) {}

  double step(double input, float dt_s) noexcept;
  /// Settled on this value.
  void reset(double value) noexcept;
  /// As new: settles on the next input.
  void reset() noexcept { started_ = false; }
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  Config config_;
  double value_ = 0.0;
  bool started_ = false;
  float designed_dt_s_ = 0.0F;
  double damping_ = 0.0;
  TwoPoleFilter filter_;
};

}  // namespace rc10
