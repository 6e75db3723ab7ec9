#include "robot_client/robots_heard.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

constexpr std::string_view kStateChannel = ".v1.state";

}  // namespace

RobotsHeard::RobotsHeard(const LcmLink& link)
    : subscription_(link.subscribePattern(R"([^.]+\.v1\.state)", [this](const std::string& channel) {
        const std::lock_guard lock(mutex_);
        names_.insert(channel.substr(0, channel.size() - kStateChannel.size()));
        changed_.notify_all();
      })) {}

std::string RobotsHeard::names(Duration patience) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [this] { return !names_.empty(); });
  std::string text;
  for (const auto& name : names_) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

}  // namespace robot_client
}  // namespace rc10
