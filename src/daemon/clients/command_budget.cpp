#include "daemon/clients/command_budget.hpp"

#include <algorithm>
#include <chrono>

namespace rc10 {
namespace {

// A burst after a pause of the computer or of a network: two ticks' worth, as much as the ring holds.
constexpr double kMostTokens = 2.0 * CommandBudget::kSetpoints;
// Silence after which a client leaves its share to the others.
constexpr Duration kSilent = std::chrono::milliseconds{100};
constexpr std::size_t kMaxAccounts = 64;

}  // namespace

bool CommandBudget::spend(std::string_view client, std::size_t setpoints, MonotonicTime now) {
  auto entry = accounts_.find(client);
  if (entry == accounts_.end()) {
    if (accounts_.size() >= kMaxAccounts) {
      accounts_.erase(std::min_element(accounts_.begin(), accounts_.end(), [](const auto& a, const auto& b) {
        return a.second.last < b.second.last;
      }));
    }
    entry = accounts_.emplace(client, Account{kMostTokens, now}).first;
  }
  Account& account = entry->second;
  const double elapsed_ms = std::chrono::duration<double, std::milli>(now - account.last).count();
  account.last = now;
  const double share = per_ms_ / static_cast<double>(sending(now));
  account.tokens = std::min(kMostTokens, account.tokens + elapsed_ms * share);
  const auto cost = static_cast<double>(std::max(setpoints, kLeastCost));
  if (account.tokens < cost) return false;
  account.tokens -= cost;
  return true;
}

std::size_t CommandBudget::sending(MonotonicTime now) const noexcept {
  return static_cast<std::size_t>(std::count_if(accounts_.begin(), accounts_.end(), [now](const auto& entry) {
    return now - entry.second.last <= kSilent;
  }));
}

}  // namespace rc10
