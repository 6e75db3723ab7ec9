#pragma once

#include <bitset>
#include <span>

#include "daemon/devices/robot.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

/// Watches the interfaces of the buses and brings a bus back when its interface comes back. A new
/// socket takes the place of the old one under the same descriptor number (dup3), so that the
/// real-time threads need not know. io thread only.
class BusReviver {
 public:
  BusReviver(Robot& robot, std::span<BusInbox> inboxes) : robot_(robot), inboxes_(inboxes) {}

  /// Looks at every interface once. To be called some 20 times a second. Returns the buses that have come up:
  /// also those that were down so briefly that only their socket knew.
  std::bitset<kMaxBuses> check() noexcept;

 private:
  [[nodiscard]] bool reopen(std::size_t bus);

  Robot& robot_;
  std::span<BusInbox> inboxes_;
};

}  // namespace rc10
