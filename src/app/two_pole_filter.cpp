#include "app/two_pole_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/units.hpp"

namespace rc10 {
namespace {

/// Larger input counts as this, so that no sum inside overflows.
constexpr double kHugeInput = 1e100;

}  // namespace

void TwoPoleFilter::settle(double input) noexcept {
  high_ = 0.0;
  band_ = 0.0;
  low_ = input;
}

void TwoPoleFilter::step(double input, double per_sample, double damping) noexcept {
  if (per_sample != per_sample_) {
    per_sample_ = per_sample;
    gain_ = std::tan(std::numbers::pi * per_sample);
  }
  const double g = gain_;
  // Each integrator adds g times (its input before + its input now).
  const double band_before = band_ + g * high_;
  const double low_before = low_ + g * band_;
  high_ = (input - (damping + g) * band_before - low_before) / (1.0 + damping * g + g * g);
  band_ = band_before + g * high_;
  low_ = low_before + g * band_;
}

double ButterworthLowPass::step(double input, float dt_s) noexcept {
  if (!(dt_s > 0.0F) || !std::isfinite(input)) return value_;
  input = std::clamp(input, -kHugeInput, kHugeInput);
  if (!started_ || !(cutoff_hz_ > 0.0)) {
    reset(input);
    return value_;
  }
  const double per_sample = std::min(cutoff_hz_ * static_cast<double>(dt_s), TwoPoleFilter::kMostOfRate);
  filter_.step(input, per_sample, std::numbers::sqrt2);
  value_ = filter_.lowPass();
  return value_;
}

void ButterworthLowPass::reset(double value) noexcept {
  if (!std::isfinite(value)) return;
  value_ = std::clamp(value, -kHugeInput, kHugeInput);
  filter_.settle(value_);
  started_ = true;
}

double Notch::step(double input, float dt_s) noexcept {
  if (!(dt_s > 0.0F) || !std::isfinite(input)) return value_;
  input = std::clamp(input, -kHugeInput, kHugeInput);
  const auto dt = static_cast<double>(dt_s);
  const double per_sample = config_.centre_hz * dt;
  const bool filters = config_.width_hz > 0.0 && per_sample > 0.0 && per_sample <= TwoPoleFilter::kMostOfRate;
  if (!started_ || !filters) {
    reset(input);
    return value_;
  }
  if (dt_s != designed_dt_s_) {
    designed_dt_s_ = dt_s;
    // The bilinear transform bends frequencies: with this damping the width between the edges is right
    // all the same (S. Orfanidis, Introduction to Signal Processing).
    const double width = std::min(config_.width_hz * dt, TwoPoleFilter::kMostOfRate);
    damping_ = 2.0 * std::tan(std::numbers::pi * width) / std::sin(kRadPerTurn * per_sample);
  }
  filter_.step(input, per_sample, damping_);
  value_ = filter_.highPass() + filter_.lowPass();
  return value_;
}

void Notch::reset(double value) noexcept {
  if (!std::isfinite(value)) return;
  value_ = std::clamp(value, -kHugeInput, kHugeInput);
  filter_.settle(value_);
  started_ = true;
}

}  // namespace rc10
