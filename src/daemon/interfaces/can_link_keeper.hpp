#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "app/time.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/note.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/interfaces/can_link.hpp"
#include "daemon/interfaces/can_link_recovery.hpp"

namespace rc10 {

/// Looks after the links of the CAN buses: with `manage_link` it takes the interface of a bus in trouble down
/// and up, else it says once which command to type. io thread only; nobody waits for it.
class CanLinkKeeper {
 public:
  /// Where it reads and writes links. Tests give their own.
  struct Driver {
    Result<CanLink> (*read)(const std::string& interface) = readCanLink;
    Result<void> (*restart)(const std::string& interface, const CanLinkSettings& wanted) = restartCanLink;
  };

  CanLinkKeeper(Robot& robot, std::span<BusInbox> inboxes, LinkExchange& exchange)
      : CanLinkKeeper(robot, inboxes, exchange, Driver{}) {}
  CanLinkKeeper(Robot& robot, std::span<BusInbox> inboxes, LinkExchange& exchange, Driver driver)
      : robot_(robot), inboxes_(inboxes), notes_(exchange.notes, EventCode::kBusAdvice), driver_(driver) {}

  /// Looks at every bus once. `came_up`: of these somebody may have changed the settings.
  void check(MonotonicTime now, std::bitset<kMaxBuses> came_up);

 private:
  struct Kept {
    CanLinkRecovery recovery;
    bool by_us = false;  ///< The interface comes up because we restarted it.
    std::string last_error;
  };

  void recover(std::size_t bus, BusState why, MonotonicTime now);
  [[nodiscard]] bool restart(std::size_t bus, MonotonicTime now);
  void advise(std::size_t bus, BusState why, const CanLink& link, MonotonicTime now);
  /// True: it has restarted the link.
  [[nodiscard]] bool mendSettings(std::size_t bus, MonotonicTime now);
  [[nodiscard]] std::string_view nameOf(std::size_t bus) const;

  Robot& robot_;
  std::span<BusInbox> inboxes_;
  Notes notes_;
  Driver driver_;
  std::array<Kept, kMaxBuses> kept_{};
};

/// Wrong settings of a link that rc10d does not manage, and the command that mends them; empty: none.
[[nodiscard]] std::string settingsAdvice(const std::string& interface, const CanLink& link,
                                         const CanLinkSettings& wanted);

}  // namespace rc10
