#include "drives/damiao/damiao_position.hpp"

#include <cmath>

#include "drives/damiao/damiao_frames.hpp"
#include "motor/sample_spacing.hpp"

namespace rc10 {
namespace {

constexpr std::int64_t kWrap = 65536;
// Share of half the range: beyond, the shorter way round may be the wrong one.
constexpr double kSureShare = 0.8;
constexpr double kSlackRad = 0.1;  // noise
// Between the register and the feedback next to it the motor turns on.
constexpr double kAskedApartSeconds = 0.05;
// No count of a drive is as large; keeps garbage from overflowing.
constexpr double kFarthestCountRad = 1e7;

}  // namespace

DamiaoPosition::DamiaoPosition(const DamiaoScale& scale, double fastest_rad_s, Duration period) noexcept
    : scale_(scale),
      fastest_rad_s_(fastest_rad_s),
      period_(period),
      longest_silence_(longestSilence(scale, fastest_rad_s)),
      step_rad_(damiao::positionStep(scale)) {}

Duration DamiaoPosition::longestSilence(const DamiaoScale& scale, double fastest_rad_s) noexcept {
  const std::chrono::duration<double> silence_s{kSureShare * scale.p_max_rad / fastest_rad_s};
  return std::chrono::duration_cast<Duration>(silence_s);
}

double DamiaoPosition::rad() const noexcept {
  return static_cast<double>(code_) * step_rad_ - scale_.p_max_rad;
}

void DamiaoPosition::forget() noexcept {
  known_ = false;
  begun_ = false;
}

DamiaoPosition::Step DamiaoPosition::take(std::uint16_t code, MonotonicTime received) noexcept {
  if (!begun_) {
    begun_ = true;
    code_ = code;
    received_ = received;
    return Step::kFollows;
  }
  const Duration gap = received - received_;
  received_ = received;
  const auto moved = static_cast<std::int16_t>(static_cast<std::uint16_t>(code - code_));
  const double reach_rad =
      fastest_rad_s_ * static_cast<double>(seconds(longestApart(gap, period_))) + kSlackRad;
  Step step = Step::kFollows;
  if (std::fabs(moved * step_rad_) > reach_rad) step = Step::kJumped;
  if (std::chrono::abs(gap) > longest_silence_) step = Step::kLost;
  if (step == Step::kFollows) {
    code_ += moved;
  } else {
    code_ = code;
    known_ = false;
  }
  return step;
}

DamiaoPosition::Wrap DamiaoPosition::take(float register_rad) noexcept {
  const double asked_rad = static_cast<double>(register_rad);
  // NaN is a contradiction, too.
  if (!begun_ || !(std::fabs(asked_rad) < kFarthestCountRad)) return Wrap::kContradiction;
  const double wraps = std::round((asked_rad - rad()) / (kWrap * step_rad_));
  const double apart_rad = std::fabs(asked_rad - rad() - wraps * kWrap * step_rad_);
  if (apart_rad > kSlackRad + fastest_rad_s_ * kAskedApartSeconds) return Wrap::kContradiction;
  code_ += static_cast<std::int64_t>(wraps) * kWrap;
  known_ = true;
  return wraps == 0.0 ? Wrap::kSame : Wrap::kOther;
}

}  // namespace rc10
