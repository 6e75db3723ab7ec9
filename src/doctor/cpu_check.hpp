#pragma once

#include <optional>
#include <string>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/host_files.hpp"

namespace rc10::doctor {

struct CpuFacts {
  std::vector<int> online;
  std::vector<int> isolated;
  std::vector<std::string> governors;  ///< Governors of the CPUs that change their frequency, each word once.
};

[[nodiscard]] CpuFacts readCpus(const HostFiles& files);

/// Whether the CPUs keep their frequency.
[[nodiscard]] Finding checkGovernor(const CpuFacts& cpus);
/// CPUs to which the configuration pins threads of rc10d.
struct PinnedThreads {
  std::optional<int> scheduler;
  std::optional<int> rx;
  bool rx_reads_can = false;  ///< `receive: thread`; else it has no deadline, and may share its CPU.
};

/// Whether the CPUs that rc10d is pinned to exist, and those of threads with a deadline are its own.
[[nodiscard]] Finding checkIsolation(const CpuFacts& cpus, const PinnedThreads& threads);

}  // namespace rc10::doctor
