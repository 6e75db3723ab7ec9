#pragma once

#include <sys/types.h>

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "config/client_config.hpp"
#include "daemon/exchange/orders.hpp"

namespace rc10 {

inline constexpr std::size_t kMaxClientEntries = 32;

/// Entries of `clients` that are of one sender, by their places.
using GrantSet = std::bitset<kMaxClientEntries>;

/// Sender of a message, as far as the kernel and the gateway vouch for it.
struct Speaker {
  enum class Way : std::uint8_t {
    kSocket,   ///< Peer of the link socket; the kernel has told the user.
    kLcm,      ///< LCM on this computer; the name is the message's own.
    kNetwork,  ///< LCM from another computer: anybody.
  };
  std::uint64_t connection = 0;
  Way way = Way::kSocket;
  uid_t user = 0;
  GrantSet grants{};
  bool unknown_token = false;  ///< It has shown one of no entry.

  /// Owner of sessions, and of answers that are remembered: the user, so that one who comes back finds them;
  /// of what comes by LCM all that is sent there, over ends of the gateway.
  [[nodiscard]] std::uint64_t owner() const noexcept {
    return way == Way::kSocket ? user : ~std::uint64_t{0} - static_cast<std::uint64_t>(way);
  }
  /// Key of what it may send: the name in a message is its own choice, and a sender with many names is one.
  [[nodiscard]] std::string account(std::string_view client) const {
    return way == Way::kSocket ? std::to_string(connection) + '/' : '/' + std::string{client};
  }
};

/// Rights of senders: `clients`, `clear: local` and `tuning: locked`. Link thread only. A refusal is a text
/// that says who lacks which right, and which line of the file would grant it.
class Permissions {
 public:
  /// `clients` that are none: everybody may do everything.
  struct Rules {
    std::optional<ClientsConfig> clients;
    ForbiddenAt tuning_locked_at = 0;
    ForbiddenAt clear_local_at = 0;
    std::string file;
    std::vector<std::string> motors;
    std::vector<std::string> modules;
  };

  /// Everybody may do everything.
  Permissions() = default;
  /// Looks up users and groups in the files of `etc`. An error names the line of one that is not there.
  [[nodiscard]] static Result<Permissions> resolve(Rules rules, const std::string& etc = "/etc");

  [[nodiscard]] GrantSet ofUser(uid_t user, const std::vector<gid_t>& groups) const;
  /// `token`: as it was shown.
  [[nodiscard]] GrantSet ofToken(std::string_view token) const;
  [[nodiscard]] GrantSet ofLcmClient(std::string_view name) const;

  // Empty: allowed.
  [[nodiscard]] std::string whyNoCommand(const Speaker& speaker, std::string_view client,
                                         const MotorSet& motors, std::int32_t priority) const;
  [[nodiscard]] std::string whyNoSignals(const Speaker& speaker, std::string_view client, std::size_t module,
                                         std::int32_t priority) const;
  /// `whole_robot`: the request named no motor.
  [[nodiscard]] std::string whyNoRequest(const Speaker& speaker, std::string_view client, Right right,
                                         const MotorSet& motors, bool whole_robot) const;
  [[nodiscard]] std::string whyOtherSession(std::string_view client) const;

 private:
  struct Entry {
    ClientConfig config;
    std::optional<std::uint32_t> id;  ///< Id of the user or group.
    MotorSet motors;
    std::bitset<link::kMaxModules> modules;
  };

  [[nodiscard]] std::string whyNoName(std::string_view client) const;
  template <typename Places>
  [[nodiscard]] std::string whyNot(const Speaker& speaker, std::string_view client, Right right,
                                   const Places& wanted, std::optional<std::int32_t> priority) const;
  [[nodiscard]] std::string lacking(const Speaker& speaker, std::string_view client, Right right,
                                    const std::string& what, const char* list,
                                    std::optional<std::int32_t> priority, bool has_place) const;
  [[nodiscard]] std::string at(int line) const;
  [[nodiscard]] std::string clientsPlace() const;

  Rules rules_;
  std::vector<Entry> entries_;
};

}  // namespace rc10
