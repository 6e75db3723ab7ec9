#include "daemon/clients/permissions.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "app/account_ids.hpp"
#include "app/printable.hpp"
#include "config/sha256.hpp"

namespace rc10 {
namespace {

[[nodiscard]] std::optional<std::uint32_t> accountId(const ClientConfig& client, const std::string& etc) {
  std::uint32_t number = 0;
  const char* end = client.who.data() + client.who.size();
  const auto parsed = std::from_chars(client.who.data(), end, number);
  if (parsed.ec == std::errc{} && parsed.ptr == end) return number;
  return client.by == ClientConfig::By::kUser ? userId(client.who, etc) : groupId(client.who, etc);
}

[[nodiscard]] std::string_view wordOf(Right right) { return kRightWords[static_cast<std::size_t>(right)]; }

[[nodiscard]] std::string speakerWords(const Speaker& speaker, std::string_view client) {
  auto name = printable(client);
  switch (speaker.way) {
    case Speaker::Way::kSocket:
      return fmt::format("'{}' (user {}{})", name, speaker.user,
                         speaker.unknown_token ? ", its token is in no entry of `clients`" : "");
    case Speaker::Way::kLcm: return fmt::format("'{}' (LCM, this computer)", name);
    case Speaker::Way::kNetwork: return fmt::format("'{}' (LCM, another computer)", name);
  }
  return name;
}

[[nodiscard]] const MotorSet& placesOf(const MotorSet& motors,
                                       const std::bitset<link::kMaxModules>& /*modules*/,
                                       const MotorSet& /*of*/) {
  return motors;
}
[[nodiscard]] const std::bitset<link::kMaxModules>& placesOf(const MotorSet& /*motors*/,
                                                             const std::bitset<link::kMaxModules>& modules,
                                                             const std::bitset<link::kMaxModules>& /*of*/) {
  return modules;
}

}  // namespace

Result<Permissions> Permissions::resolve(Rules rules, const std::string& etc) {
  Permissions out;
  out.rules_ = std::move(rules);
  if (!out.rules_.clients) return out;
  for (const auto& client : out.rules_.clients->entries) {
    Entry entry{.config = client, .id = std::nullopt, .motors = {}, .modules = {}};
    if (client.all_motors) entry.motors.set();
    if (client.all_modules) entry.modules.set();
    for (const auto motor : client.motors) entry.motors.set(motor);
    for (const auto module : client.modules) entry.modules.set(module);
    if (client.by == ClientConfig::By::kUser || client.by == ClientConfig::By::kGroup) {
      entry.id = accountId(client, etc);
      const bool user = client.by == ClientConfig::By::kUser;
      if (!entry.id) {
        return fail(fmt::format(
            "{}: clients: there is no {} '{}' on this computer ({}/{}): make it, or name "
            "another",
            out.at(client.line), user ? "user" : "group", client.who, etc, user ? "passwd" : "group"));
      }
    }
    out.entries_.push_back(std::move(entry));
  }
  return out;
}

GrantSet Permissions::ofUser(uid_t user, const std::vector<gid_t>& groups) const {
  GrantSet grants;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto& [config, id, motors, modules] = entries_[i];
    const bool is_user = config.by == ClientConfig::By::kUser && id == user;
    const bool is_member = config.by == ClientConfig::By::kGroup && id &&
                           std::find(groups.begin(), groups.end(), *id) != groups.end();
    grants.set(i, is_user || is_member);
  }
  return grants;
}

GrantSet Permissions::ofToken(std::string_view token) const {
  GrantSet grants;
  const auto hash = sha256(token);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto& config = entries_[i].config;
    grants.set(i, config.by == ClientConfig::By::kToken && config.who == hash);
  }
  return grants;
}

GrantSet Permissions::ofLcmClient(std::string_view name) const {
  GrantSet grants;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto& config = entries_[i].config;
    grants.set(i, config.by == ClientConfig::By::kLcmName && config.who == name);
  }
  return grants;
}

std::string Permissions::at(int line) const { return fmt::format("{}:{}", rules_.file, line); }
std::string Permissions::clientsPlace() const { return at(rules_.clients ? rules_.clients->line : 1); }

std::string Permissions::whyNoName(std::string_view client) const {
  if (std::find(rules_.modules.begin(), rules_.modules.end(), client) == rules_.modules.end()) return {};
  return fmt::format("'{}' is a module, whose name no client may use: give the program another name", client);
}

template <typename Places>
std::string Permissions::whyNot(const Speaker& speaker, std::string_view client, Right right,
                                const Places& wanted, std::optional<std::int32_t> priority) const {
  if (auto reason = whyNoName(client); !reason.empty()) return reason;
  if (!rules_.clients) return {};
  Places granted;
  Places granted_lower;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto& entry = entries_[i];
    if (!speaker.grants.test(i) || !entry.config.has(right)) continue;
    const auto& places = placesOf(entry.motors, entry.modules, wanted);
    granted_lower |= places;
    if (!priority || *priority <= entry.config.max_priority) granted |= places;
  }
  const Places missing = wanted & ~granted;
  if (missing.none()) return {};
  std::size_t first = 0;
  while (!missing.test(first)) ++first;
  constexpr bool kOfMotors = std::is_same_v<Places, MotorSet>;
  const auto& names = kOfMotors ? rules_.motors : rules_.modules;
  return lacking(speaker, client, right, first < names.size() ? names[first] : "?",
                 kOfMotors ? "motors" : "modules", priority, granted_lower.test(first));
}

// The line that would grant it is that of the sender's entry which lacks least.
std::string Permissions::lacking(const Speaker& speaker, std::string_view client, Right right,
                                 const std::string& what, const char* list,
                                 std::optional<std::int32_t> priority, bool has_place) const {
  const auto who = speakerWords(speaker, client);
  if (speaker.way == Speaker::Way::kNetwork) {
    return fmt::format(
        "{} may observe and stop, not {}: nobody vouches for names there; run it on this "
        "computer ({})",
        who, wordOf(right), clientsPlace());
  }
  const Entry* with_right = nullptr;
  const Entry* any = nullptr;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (!speaker.grants.test(i)) continue;
    if (any == nullptr) any = &entries_[i];
    if (with_right == nullptr && entries_[i].config.has(right)) with_right = &entries_[i];
  }
  if (with_right != nullptr && has_place && priority) {
    return fmt::format("{} may not {} {} with priority {}: raise max_priority at {}", who, wordOf(right),
                       what, *priority, at(with_right->config.line));
  }
  if (with_right != nullptr)
    return fmt::format("{} may not {} {}: add it to `{}` at {}", who, wordOf(right), what, list,
                       at(with_right->config.line));
  if (any != nullptr)
    return fmt::format("{} may not {} {}: add {} to `may` at {}", who, wordOf(right), what, wordOf(right),
                       at(any->config.line));
  const bool by_lcm = speaker.way == Speaker::Way::kLcm;
  return fmt::format("{} may observe and stop, not {} {}: add `- {{{}: {}, may: [{}]}}` to clients at {}",
                     who, wordOf(right), what, by_lcm ? "lcm" : "user",
                     by_lcm ? printable(client) : std::to_string(speaker.user), wordOf(right),
                     clientsPlace());
}

std::string Permissions::whyNoCommand(const Speaker& speaker, std::string_view client, const MotorSet& motors,
                                      std::int32_t priority) const {
  return whyNot(speaker, client, Right::kCommand, motors, priority);
}

std::string Permissions::whyNoSignals(const Speaker& speaker, std::string_view client, std::size_t module,
                                      std::int32_t priority) const {
  std::bitset<link::kMaxModules> wanted;
  wanted.set(module);
  return whyNot(speaker, client, Right::kCommand, wanted, priority);
}

std::string Permissions::whyNoRequest(const Speaker& speaker, std::string_view client, Right right,
                                      const MotorSet& motors, bool whole_robot) const {
  const bool tunes = right == Right::kTune || right == Right::kConfigure;
  if (tunes && rules_.tuning_locked_at != 0) {
    return fmt::format("gains and settings of drives are locked while rc10d runs: `tuning: locked` at {}",
                       at(rules_.tuning_locked_at));
  }
  const bool from_elsewhere = speaker.way == Speaker::Way::kNetwork;
  if (right == Right::kClear && whole_robot && from_elsewhere && rules_.clear_local_at != 0) {
    return fmt::format("an e-stop is cleared on the robot's computer only: `clear: local` at {}",
                       at(rules_.clear_local_at));
  }
  return whyNot(speaker, client, right, motors, std::nullopt);
}

std::string Permissions::whyOtherSession(std::string_view client) const {
  return fmt::format("its session is one that another program uses as '{}': choose a random one",
                     printable(client));
}

}  // namespace rc10
