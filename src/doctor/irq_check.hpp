#pragma once

#include <string>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/process_list.hpp"

namespace rc10::doctor {

/// Whether the threads that serve an interface (threadsOf()) are above rc10d's own. `rx_priority`: the higher
/// one of those.
[[nodiscard]] Finding checkInterruptThreads(const std::string& interface, const std::vector<Process>& threads,
                                            int rx_priority);

}  // namespace rc10::doctor
