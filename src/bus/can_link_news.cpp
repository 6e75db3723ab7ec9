#include "bus/can_link_news.hpp"

#include <linux/if_link.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <algorithm>

#include "bus/netlink_attributes.hpp"

namespace rc10 {

std::vector<CanLinkNews> parseLinkNews(netlink::Bytes datagram) {
  std::vector<CanLinkNews> news;
  for (;;) {
    const auto header = netlink::readAs<nlmsghdr>(datagram);
    if (!header || header->nlmsg_len < sizeof(nlmsghdr) || header->nlmsg_len > datagram.size()) return news;
    const auto payload = datagram.first(header->nlmsg_len).subspan(sizeof(nlmsghdr));
    const auto info = netlink::readAs<ifinfomsg>(payload);
    if (header->nlmsg_type == RTM_NEWLINK && info) {
      const auto attributes = payload.subspan(sizeof(ifinfomsg));
      news.push_back({.interface = netlink::text(netlink::attribute(attributes, IFLA_IFNAME)),
                      .is_can = info->ifi_type == ARPHRD_CAN,
                      .up = (info->ifi_flags & IFF_UP) != 0});
    }
    datagram = datagram.subspan(std::min(datagram.size(), std::size_t{NLMSG_ALIGN(header->nlmsg_len)}));
  }
}

}  // namespace rc10
