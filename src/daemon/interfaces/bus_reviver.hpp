#pragma once

#include <array>
#include <bitset>
#include <span>
#include <string>

#include "app/unique_fd.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/note.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/interfaces/interface_locks.hpp"

namespace rc10 {

/// Watches the interfaces of the buses and brings a bus back when its interface comes back. A new
/// socket takes the place of the old one under the same descriptor number (dup3), so that the
/// real-time threads need not know. io thread only.
class BusReviver {
 public:
  BusReviver(Robot& robot, std::span<BusInbox> inboxes, LinkExchange& exchange, InterfaceLocks& locks);

  /// Looks at every interface once. To be called some 20 times a second. Returns the buses that have come up:
  /// also those that were down so briefly that only their socket knew.
  std::bitset<kMaxBuses> check(MonotonicTime now) noexcept;

 private:
  [[nodiscard]] bool reopen(std::size_t bus, MonotonicTime now);

  Robot& robot_;
  std::span<BusInbox> inboxes_;
  Notes notes_;
  InterfaceLocks& locks_;
  UniqueFd asks_;  ///< Any socket answers for an interface. Kept: later there may be no descriptor left.
  std::array<std::string, kMaxBuses> told_{};  ///< Reason why a bus could not be had, as told last.
};

}  // namespace rc10
