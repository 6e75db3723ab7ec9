#pragma once

namespace rc10 {

/// SCHED_FIFO priority of rc10-guard: above every thread of rc10d, since one that hangs may be among them.
/// The highest that a process of rc10 asks for; systemd/limits.d/rc10d.conf gives it to rc10-dev.
inline constexpr int kGuardPriority = 80;

}  // namespace rc10
