#pragma once

#include <string>
#include <vector>

#include "doctor/host_files.hpp"
#include "doctor/process_list.hpp"

namespace rc10::doctor {

/// Priority from rc10-irq: above rc10d's receive thread with its 65, and below what the kernel needs.
inline constexpr int kInterruptPriority = 70;

/// The CAN interfaces of this computer, sorted.
[[nodiscard]] std::vector<std::string> canInterfaces(const HostFiles& files);

/// The threads of the kernel through which the frames of an interface come and go: those of its interrupt,
/// and of the SPI controller that its chip hangs on.
[[nodiscard]] std::vector<Process> threadsOf(const std::string& interface, const HostFiles& files,
                                             const std::vector<Process>& processes);

/// "50", "not real-time"
[[nodiscard]] std::string priorityText(const Process& thread);

/// A thread of an interface that has another priority than it should.
struct PriorityChange {
  std::string interface;
  Process thread;
};

/// Changes that give all threads of these interfaces one priority. A thread that serves several is named
/// once.
[[nodiscard]] std::vector<PriorityChange> priorityChanges(const std::vector<std::string>& interfaces,
                                                          int priority, const HostFiles& files,
                                                          const std::vector<Process>& processes);

/// Reason why an interface has fewer threads than one may expect, for people; empty: it has them.
[[nodiscard]] std::string missingThreads(const std::string& interface, const HostFiles& files,
                                         const std::vector<Process>& processes);

}  // namespace rc10::doctor
