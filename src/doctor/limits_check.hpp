#pragma once

#include <optional>
#include <string>

#include "doctor/finding.hpp"
#include "doctor/host_files.hpp"

namespace rc10::doctor {

/// Limits of a process, from /proc/PID/limits and /proc/PID/status.
struct LimitFacts {
  static constexpr long long kUnlimited = -1;

  std::string process = "self";  ///< "self", or a process number.
  std::optional<long long> realtime_priority;
  std::optional<long long> locked_bytes;  ///< kUnlimited or a number.
  bool may_anyway = false;                ///< It has the capabilities that make these limits meaningless.
};

/// `process`: "self" or a pid.
[[nodiscard]] LimitFacts readLimits(const HostFiles& files, const std::string& process);

/// Whether rc10d's service is installed on this computer: it has limits of its own.
[[nodiscard]] bool serviceInstalled(const HostFiles& files);

/// Highest priorities that the processes of a robot ask for.
struct PriorityNeeds {
  int rc10d = 0;
  bool guard = false;  ///< rc10-guard runs beside rc10d and asks for kGuardPriority.
};

/// `who`: "rc10d (pid 12)" or "this shell"; `service`: a shell's limits matter less where there is a service.
[[nodiscard]] Finding checkRealtimeLimit(const LimitFacts& limits, const std::string& who, bool service,
                                         const PriorityNeeds& needs);
[[nodiscard]] Finding checkMemoryLimit(const LimitFacts& limits, const std::string& who, bool service);

}  // namespace rc10::doctor
