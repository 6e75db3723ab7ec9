#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rc10 {

/// Reason why a tick began late or took long, as far as the kernel tells.
enum class LateCause : std::uint8_t {
  kPageFault,
  kCpuTaken,
  kTimer,
  kReceive,
  kModules,
  kControl,
  kSend,
  kPublish
};

struct LateCauseWords {
  std::string_view counter;  ///< Name of its counter in the diagnostics.
  std::string_view advice;
};

inline constexpr std::size_t kLateCauses = 8;
inline constexpr std::array<LateCauseWords, kLateCauses> kLateCauseWords{{
    {"late ticks: page fault", "memory was not there: see locked memory in rc10ctl doctor"},
    {"late ticks: CPU taken",
     "others ran on its CPU, not real-time or hidden (ProtectProc= of the unit: docs/lcm.md): keep one for "
     "it "
     "(docs/realtime.md), or raise scheduler.priority"},
    {"late ticks: timer",
     "it was woken late: interrupts off, a CPU in deep sleep, a computer or process that paused, or "
     "timer: timerfd on PREEMPT_RT, which any real-time thread holds up; see rc10ctl doctor"},
    {"late ticks: receiving", "many frames or bytes at once: see the load of the buses, and foreign senders"},
    {"late ticks: modules", "orders and modules took long: a lower rate_hz, or fewer modules"},
    {"late ticks: control", "the loops of the motors took long: a lower rate_hz, or a faster CPU"},
    {"late ticks: sending",
     "the kernel took long to take the frames: see the driver of the interface and its interrupts"},
    {"late ticks: publishing", "the snapshot and the black box took long: a lower rate_hz, or a faster CPU"},
}};

/// Begin of a counter that ends with the name of a thread.
inline constexpr LateCauseWords kTakenByWords{
    "late ticks: CPU taken by ",
    "a real-time thread of rc10d's priority or above: lower it (`chrt`), or keep a CPU for rc10d "
    "(docs/realtime.md)"};

}  // namespace rc10
