#pragma once

#include <map>
#include <string>

#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

/// Modules to which inputs are sent and of which nothing is heard, though the robot is: a misspelt name.
/// Pure.
class SilentModules {
 public:
  /// Inputs go to `module`. True, once for each: it is to be told as missing.
  [[nodiscard]] bool sent(const std::string& module, bool module_heard, bool robot_heard, MonotonicTime now) {
    if (module_heard || !robot_heard) {
      since_.erase(module);
      return false;
    }
    auto& silence = since_.try_emplace(module, Silence{now}).first->second;
    if (silence.told || now - silence.began <= kSilence) return false;
    silence.told = true;
    return true;
  }

 private:
  // A module's outputs come as often as the robot's state.
  static constexpr Duration kSilence = std::chrono::seconds{1};

  struct Silence {
    MonotonicTime began;
    bool told = false;
  };
  std::map<std::string, Silence> since_;
};

}  // namespace robot_client
}  // namespace rc10
