#pragma once

#include <string>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/process_list.hpp"

namespace rc10::doctor {

/// The thread of rc10d that reads the CAN sockets.
struct CanReader {
  int priority = 0;
  bool is_rx = false;  ///< The rx thread, `receive: thread`; else the scheduler.
};

/// Whether the threads that serve an interface (threadsOf()) are above the one that reads their frames.
[[nodiscard]] Finding checkInterruptThreads(const std::string& interface, const std::vector<Process>& threads,
                                            const CanReader& reader);

}  // namespace rc10::doctor
