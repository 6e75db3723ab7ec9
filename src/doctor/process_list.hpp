#pragma once

#include <string>
#include <vector>

#include "doctor/host_files.hpp"

namespace rc10::doctor {

/// One process or thread of the kernel, from /proc.
struct Process {
  int pid = 0;
  std::string name;   ///< At most 15 characters: the kernel keeps no more.
  bool fifo = false;  ///< SCHED_FIFO or SCHED_RR.
  int priority = 0;   ///< Of a fifo one.
};

[[nodiscard]] std::vector<Process> readProcesses(const HostFiles& files);

}  // namespace rc10::doctor
