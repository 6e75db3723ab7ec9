#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10 {

/// Process-wide real-time preparation. Main thread, before any other thread exists.
///
/// One malloc arena that never shrinks and never maps (what is freed stays resident), and small stacks
/// for threads of libraries, whose size locked memory counts whole.
void configureMemory() noexcept;

/// Locks all present and future memory. The error says which limit is too small and how to raise it.
[[nodiscard]] Result<void> lockMemory();

/// Keeps the CPUs out of deep idle states while the descriptor is open. Empty where the kernel has no
/// such file or does not let us: then nothing is lost but some wake-up latency.
[[nodiscard]] UniqueFd holdCpuDmaLatency() noexcept;

/// No core file, which takes its time before the guard sees the end; and no other process of this user traces
/// or writes into this one.
void forbidDumps() noexcept;

/// PREEMPT_RT, where a timerfd is no match for clock_nanosleep().
[[nodiscard]] bool kernelIsPreemptRt();

/// Minor and major page faults of one thread of this process so far, from /proc.
[[nodiscard]] std::uint64_t pageFaults(int tid) noexcept;
/// For waitedForCpu() of one thread of this process. Empty: a kernel without CONFIG_SCHED_INFO.
[[nodiscard]] UniqueFd openSchedstat(int tid) noexcept;
/// Time for which the thread was ready to run while others had its CPU. None: not known.
[[nodiscard]] std::optional<Duration> waitedForCpu(const UniqueFd& schedstat) noexcept;

}  // namespace rc10
