#pragma once

#include "acme_motor.hpp"
#include "motor/cascade.hpp"
#include "motor/sample_spacing.hpp"

namespace acme {

/// A "Turner-C": the same drive with firmware that obeys currents alone, so that the loops of velocity and
/// angle run here. Scheduler thread only.
class ACME_LoopMotor final : public ACME_Motor {
 public:
  ACME_LoopMotor(const rc10::MotorSettings& settings, const rc10::MotorTraits& traits);

  rc10::FrameVerdict updateFeedback(const rc10::CanFrame& frame) noexcept override;
  void update(const rc10::Tick& tick) noexcept override;
  bool setZero(double angle_deg) noexcept override;

  // Gains, for the state and for `rc10ctl gains`.
  [[nodiscard]] const rc10::CascadeConfig* hostLoops() const noexcept override { return &loops_.config(); }
  void retune(const rc10::CascadeConfig& loops) noexcept override { loops_.retune(loops); }

 private:
  void runLoops(const rc10::Target& target, const rc10::Tick& tick, float sample_dt_s) noexcept;

  rc10::Cascade loops_;
  rc10::SampleSpacing spacing_;
};

}  // namespace acme
