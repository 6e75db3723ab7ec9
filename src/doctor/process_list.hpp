#pragma once

#include <string>
#include <vector>

#include "doctor/host_files.hpp"

namespace rc10::doctor {

/// One process or thread of the kernel, from /proc.
struct Process {
  int pid = 0;
  std::string name;     ///< Up to Linux 5.16, and of a program always, its first 15 characters.
  bool kernel = false;  ///< A thread of the kernel.
  bool fifo = false;    ///< SCHED_FIFO or SCHED_RR.
  int priority = 0;     ///< Priority of a fifo one.
};

[[nodiscard]] std::vector<Process> readProcesses(const HostFiles& files);

}  // namespace rc10::doctor
