#include "robot_client/session/names_heard.hpp"

namespace rc10 {
inline namespace robot_client {

NamesHeard::NamesHeard(const LcmLink& link, const std::string& before, const std::string& after)
    : subscription_(link.subscribeBetween(
          before, after,
          [this, skipped = before.size() + after.size(), first = before.size()](const auto& channel) {
            const std::lock_guard lock(mutex_);
            names_.insert(channel.substr(first, channel.size() - skipped));
            changed_.notify_all();
          })) {}

std::set<std::string> NamesHeard::names(Duration patience) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [this] { return !names_.empty(); });
  return names_;
}

std::string listOf(const std::set<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

}  // namespace robot_client
}  // namespace rc10
