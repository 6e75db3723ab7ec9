#pragma once

#include <netinet/in.h>

#include <string>

#include "app/result.hpp"
#include "gateway/udpm_url.hpp"

namespace rc10::gateway {

/// The interface by which datagrams to a multicast group leave this computer, and by which those of its
/// own programs come back.
struct MulticastRoute {
  int interface_index = 0;
  std::string interface;
  bool loopback = false;
};

/// Whether an address is one of this computer, by the kernel's routes.
[[nodiscard]] bool isOwnAddress(in_addr address);

/// Asks the kernel. The error says what to do.
[[nodiscard]] Result<MulticastRoute> findRoute(const UdpmUrl& url);

/// Whether the route serves the URL: with ttl=0 it has to be the loopback, or the group is open to
/// whoever is on the network. The error says what to do.
[[nodiscard]] Result<void> checkRoute(const UdpmUrl& url, const MulticastRoute& route);

}  // namespace rc10::gateway
