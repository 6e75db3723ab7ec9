#pragma once

#include <string>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/host_files.hpp"
#include "doctor/process_list.hpp"

namespace rc10::doctor {

/// The threads of the kernel through which the frames of an interface come and go: those of its interrupt,
/// and of the SPI controller that its chip hangs on.
[[nodiscard]] std::vector<Process> threadsOf(const std::string& interface, const HostFiles& files,
                                             const std::vector<Process>& processes);

/// Whether these are above rc10d's own threads. `rx_priority`: the higher one of those.
[[nodiscard]] Finding checkInterruptThreads(const std::string& interface, const std::vector<Process>& threads,
                                            int rx_priority);

}  // namespace rc10::doctor
