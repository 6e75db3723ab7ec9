#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rc10 {

/// Change of an interface, as rtnetlink reports it.
struct CanLinkNews {
  std::string interface;
  bool is_can = false;
  bool up = false;

  bool operator==(const CanLinkNews&) const = default;
};

/// One datagram of the netlink group RTMGRP_LINK. Other messages, and those that are cut off, are left out.
[[nodiscard]] std::vector<CanLinkNews> parseLinkNews(std::span<const std::byte> datagram);

}  // namespace rc10
