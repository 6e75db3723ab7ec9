#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <string>

#include "app/time.hpp"
#include "rc10/lcm_link.hpp"

namespace rc10 {
inline namespace robot_client {

/// Listens for any robot, or any module of one, to tell a wrong name from a silent daemon.
class NamesHeard {
 public:
  /// Patience that most callers have.
  static constexpr Duration kListen = std::chrono::milliseconds{300};

  /// A name is what stands between these in a channel.
  NamesHeard(const LcmLink& link, const std::string& before, const std::string& after);

  /// Waits at most `patience` for one; empty if there is none.
  [[nodiscard]] std::set<std::string> names(Duration patience);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> names_;
  Subscription subscription_;
};

/// "'hero', 'sentry'"
[[nodiscard]] std::string listOf(const std::set<std::string>& names);

}  // namespace robot_client
}  // namespace rc10
