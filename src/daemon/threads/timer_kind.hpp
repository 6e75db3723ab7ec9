#pragma once

#include "config/robot_config.hpp"
#include "daemon/threads/periodic_timer.hpp"

namespace rc10 {

/// The timer of the scheduler. `preempt_rt`: of the kernel.
[[nodiscard]] constexpr TimerKind timerKind(TimerPolicy policy, bool preempt_rt) noexcept {
  switch (policy) {
    case TimerPolicy::kTimerfd: return TimerKind::kTimerfd;
    case TimerPolicy::kNanosleep: return TimerKind::kNanosleep;
    case TimerPolicy::kAuto: break;
  }
  return preempt_rt ? TimerKind::kNanosleep : TimerKind::kTimerfd;
}

}  // namespace rc10
