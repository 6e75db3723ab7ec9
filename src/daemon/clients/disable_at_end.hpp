#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "app/result.hpp"
#include "daemon/clients/permissions.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Motors that clients have enabled for as long as their connections last: link::kDisableAtEnd of a request.
/// However a client ends, the kernel closes its connection. Link thread only.
class DisableAtEnd {
 public:
  /// Whether a request asks for it; the error is a sentence for its sender.
  [[nodiscard]] static Result<bool> askedBy(const link::Request& request, Operation operation,
                                            const Speaker& speaker);

  /// This order asks for it.
  void add(const Order& order, std::uint64_t connection);
  /// Motors that were on before are another's.
  void finish(const OrderResult& result, const Snapshot& now);

  /// Order for the motors of connections that have ended, as soon as the last target is over. A motor that
  /// holds or brakes then does what its `on_timeout` says, and one that another client moves is that
  /// client's. One that its group may bring back is still the client's.
  [[nodiscard]] std::optional<Order> due(const Snapshot& now,
                                         const std::function<bool(std::uint64_t)>& is_open);
  /// The order was handed over.
  void taken(const Order& order);

 private:
  struct Entry {
    std::uint64_t order = 0;
    std::uint64_t connection = 0;
    link::Name client;
    MotorSet motors;
    std::optional<std::uint64_t> enabled_at{};  ///< Tick; nothing: its order is under way.
  };

  std::vector<Entry> entries_;
};

}  // namespace rc10
