#include "motor/sample_spacing.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

constexpr float kShortest = 0.1F;  // periods
constexpr float kLongest = 5.0F;   // periods
// Weight of the period's low-pass, per take: about 30 samples, long against jitter, short against a warm-up.
constexpr float kSmoothing = 0.03F;

}  // namespace

SampleSpacing::SampleSpacing(Duration nominal) noexcept
    : shortest_s_(kShortest * seconds(nominal)),
      longest_s_(kLongest * seconds(nominal)),
      period_s_(seconds(nominal)) {}

void SampleSpacing::add(Duration spacing) noexcept {
  pending_s_ += std::clamp(seconds(spacing), 0.0F, longest_s_);
  ++pending_samples_;
}

inline void SampleSpacing::takePeriods(float periods) noexcept {
  const float measured_s = std::clamp(pending_s_ / periods, shortest_s_, longest_s_);
  period_s_ += (measured_s - period_s_) * kSmoothing;  // as each measured one: between the bounds
  pending_s_ = 0.0F;
  pending_samples_ = 0;
}

float SampleSpacing::takeSeveral() noexcept {
  const float periods = std::round(pending_s_ / period_s_);
  takePeriods(periods);
  return std::clamp(periods * period_s_, shortest_s_, longest_s_);
}

// Lost frames make the spacing a multiple of the period, late ones do not change how many there are.
float SampleSpacing::take() noexcept {
  if (pending_samples_ == 0) return 0.0F;
  if (!(pending_s_ < 1.5F * period_s_)) return takeSeveral();
  takePeriods(1.0F);
  return period_s_;
}

}  // namespace rc10
