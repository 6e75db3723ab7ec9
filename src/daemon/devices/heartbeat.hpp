#pragma once

#include <cstdint>
#include <memory>

#include "app/time.hpp"
#include "daemon/devices/gpio.hpp"

namespace rc10 {

/// Toggles an output while the scheduler makes progress and lets it. An external relay that needs the wave
/// cuts the motors' power when the computer hangs; so the output is never toggled for any other reason. The
/// gpio thread's only.
class Heartbeat {
 public:
  Heartbeat(std::unique_ptr<DigitalOutput> output, Duration period)
      : output_(std::move(output)), half_period_(period / 2) {}

  /// `ticks`: Scheduler::beats() so far. False: the output refused.
  bool step(MonotonicTime now, std::uint64_t ticks) noexcept {
    if (now < next_) return true;
    next_ = next_ + half_period_ > now ? next_ + half_period_
                                       : now + half_period_;  // a late edge is not made up for
    if (ticks == ticks_) return true;
    ticks_ = ticks;
    high_ = !high_;
    return output_->set(high_);
  }
  /// When step() has something to do again.
  [[nodiscard]] MonotonicTime next() const noexcept { return next_; }
  /// At the end: low, as before the start.
  void end() noexcept { (void)output_->set(false); }

 private:
  std::unique_ptr<DigitalOutput> output_;
  Duration half_period_;
  MonotonicTime next_{};
  std::uint64_t ticks_ = 0;
  bool high_ = false;
};

}  // namespace rc10
