#pragma once

#include <string>
#include <vector>

#include "app/result.hpp"
#include "bus/can_link_news.hpp"
#include "doctor/host_files.hpp"

namespace rc10 {

/// Gives the threads that serve CAN interfaces their priority.
class ThreadPriorities {
 public:
  /// `interfaces`: empty means all CAN interfaces, whenever they appear.
  ThreadPriorities(std::vector<std::string> interfaces, int priority)
      : interfaces_(std::move(interfaces)), priority_(priority) {}

  /// Whether these may be reason for new threads.
  [[nodiscard]] bool concern(const std::vector<CanLinkNews>& news) const;

  /// Those that are there and shall be served.
  [[nodiscard]] std::vector<std::string> present() const;

  /// Sets what is not as it should be and prints a line for each; whether there was any.
  [[nodiscard]] Result<bool> apply() const;

  /// Prints which interfaces have no such threads, and why.
  void tellMissing() const;

 private:
  std::vector<std::string> interfaces_;
  int priority_;
  doctor::HostFiles files_;
};

}  // namespace rc10
