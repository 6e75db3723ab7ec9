#pragma once

#include <netinet/in.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>

#include "app/time.hpp"
#include "gateway/multicast_route.hpp"

namespace rc10::gateway {

/// Whether a datagram was sent on this computer: its sender is one of our own addresses, and the kernel takes
/// no packet from outside that says so (but with `accept_local`). The kernel is asked once a second for each
/// address, and for the latest few only.
class OwnAddresses {
 public:
  using Ask = std::function<bool(in_addr)>;

  explicit OwnAddresses(Ask ask = isOwnAddress) : ask_(std::move(ask)) {}

  [[nodiscard]] bool isOwn(in_addr sender, MonotonicTime now) {
    constexpr Duration kKept = std::chrono::seconds{1};
    for (const auto& known : known_)
      if (known.until > now && known.address.s_addr == sender.s_addr) return known.own;
    auto& entry = known_[next_++ % known_.size()];
    entry = {sender, ask_(sender), now + kKept};
    return entry.own;
  }

 private:
  struct Known {
    in_addr address{};
    bool own = false;
    MonotonicTime until{};
  };

  Ask ask_;
  std::array<Known, 8> known_{};
  std::size_t next_ = 0;
};

}  // namespace rc10::gateway
