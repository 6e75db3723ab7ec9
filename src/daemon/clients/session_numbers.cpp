#include "daemon/clients/session_numbers.hpp"

#include <algorithm>

namespace rc10 {
namespace {

// More sessions than this are not a robot's programs but those that have ended: the quietest is forgotten.
constexpr std::size_t kMaxSessions = 64;

}  // namespace

SessionNumbers::Verdict SessionNumbers::accept(std::uint64_t owner, std::string_view client,
                                               std::uint64_t session, std::int64_t seq) {
  const std::pair key{std::string(client), session};
  auto entry = sessions_.find(key);
  if (entry == sessions_.end()) {
    if (sessions_.size() >= kMaxSessions) {
      sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(), [](const auto& a, const auto& b) {
        return a.second.last_used < b.second.last_used;
      }));
    }
    entry = sessions_.emplace(key, Session{}).first;
  } else if (owner != entry->second.owner) {
    return Verdict::kOfAnother;
  } else if (seq <= entry->second.last_seq) {
    return Verdict::kOld;
  }
  entry->second = {owner, seq, ++messages_};
  return Verdict::kNew;
}

}  // namespace rc10
