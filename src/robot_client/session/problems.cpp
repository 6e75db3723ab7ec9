#include "robot_client/session/problems.hpp"

#include <cstdio>

#include "robot_client/session/host_clock.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

constexpr Duration kTellAgain = std::chrono::milliseconds{1000};

}  // namespace

void Problems::tell(const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    const auto now = timeNow();
    std::erase_if(told_, [&](const auto& entry) { return now >= entry.second + kTellAgain; });
    if (!told_.emplace(problem, now).second) return;
  }
  if (callback_) {
    callback_(problem);
  } else {
    std::fprintf(stderr, "rc10: %s: %s\n", robot_.c_str(), problem.c_str());
  }
}

}  // namespace robot_client
}  // namespace rc10
