#include "app/encoder_pll.hpp"

#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"

namespace rc10 {

const EncoderPll::State& EncoderPll::step(double measured_deg, float dt_s) noexcept {
  if (!std::isfinite(measured_deg)) return state_;
  const bool circular = config_.circular_period_deg > 0.0;
  if (!state_.running) {
    const double angle_deg = circular ? wrapPeriod(measured_deg, config_.circular_period_deg) : measured_deg;
    state_ = {.angle_deg = angle_deg, .velocity_rpm = 0.0, .running = true};
    return state_;
  }
  if (!(dt_s > 0.0F)) return state_;
  const auto dt = static_cast<double>(dt_s);

  const double pole = config_.bandwidth_rad_s > 0.0 ? std::exp(-config_.bandwidth_rad_s * dt) : 0.0;
  const double forget = 1.0 - pole;
  const double expected_deg = state_.angle_deg + state_.velocity_rpm * kDegPerSPerRpm * dt;
  const double error_deg = circular ? shortestWay(expected_deg, measured_deg, config_.circular_period_deg)
                                    : measured_deg - expected_deg;
  const double angle_deg = expected_deg + (1.0 - pole * pole) * error_deg;
  const double velocity_rpm = state_.velocity_rpm + forget * forget * error_deg / (kDegPerSPerRpm * dt);
  if (!std::isfinite(angle_deg) || !std::isfinite(velocity_rpm)) return state_;
  state_.angle_deg = circular ? wrapPeriod(angle_deg, config_.circular_period_deg) : angle_deg;
  state_.velocity_rpm = velocity_rpm;
  return state_;
}

}  // namespace rc10
