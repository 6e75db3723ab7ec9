#pragma once

#include <optional>
#include <string>

#include "doctor/finding.hpp"
#include "doctor/host_files.hpp"

namespace rc10::doctor {

struct KernelFacts {
  std::string release;  ///< "6.12.30+rpt-rpi-2712"
  std::string machine;  ///< Debian's name of it: "amd64"; empty: not known.
  bool preempt_rt = false;
  std::optional<bool> group_scheduling;  ///< CONFIG_RT_GROUP_SCHED; empty: not known.
  std::optional<long long> rt_runtime_us;
  std::optional<long long> rt_period_us;
  std::optional<long long> compact_unevictable;  ///< vm.compact_unevictable_allowed; empty: not there.
};

[[nodiscard]] KernelFacts readKernel(const HostFiles& files);

/// Whether the kernel is a real-time one.
[[nodiscard]] Finding checkPreemption(const KernelFacts& kernel);
/// Whether the kernel lets real-time threads run as long as they have to.
[[nodiscard]] Finding checkThrottling(const KernelFacts& kernel);
/// Whether locked memory stays where it is.
[[nodiscard]] Finding checkCompaction(const KernelFacts& kernel);

}  // namespace rc10::doctor
