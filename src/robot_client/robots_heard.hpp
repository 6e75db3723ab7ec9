#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <string>

#include "app/time.hpp"
#include "rc10/lcm_link.hpp"

namespace rc10 {
inline namespace robot_client {

/// Listens for any robot, to tell a wrong name from a silent daemon.
class RobotsHeard {
 public:
  explicit RobotsHeard(const LcmLink& link);

  /// Waits at most `patience` for one; the names with commas, empty if there is none.
  [[nodiscard]] std::string names(Duration patience);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> names_;
  Subscription subscription_;
};

}  // namespace robot_client
}  // namespace rc10
