#pragma once

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
/// Whether the CPUs that rc10d is pinned to (`pinned`, from the configuration) exist and are its own.
[[nodiscard]] Finding checkIsolation(const CpuFacts& cpus, const std::vector<int>& pinned);

}  // namespace rc10::doctor
