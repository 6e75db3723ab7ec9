#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

/// Reports that nobody asked for; the same text at most once a second. Any thread.
class Problems {
 public:
  using Callback = std::function<void(const std::string&)>;

  /// `robot`: named on stderr, where there is no callback.
  Problems(std::string robot, Callback callback) : robot_(std::move(robot)), callback_(std::move(callback)) {}

  void tell(const std::string& problem);

 private:
  const std::string robot_;
  const Callback callback_;
  std::mutex mutex_;
  std::map<std::string, MonotonicTime> told_;
};

}  // namespace robot_client
}  // namespace rc10
