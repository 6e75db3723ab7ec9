#include "can_link_facts.hpp"

#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "app/unique_fd.hpp"
#include "bus/interface_names.hpp"

namespace rc10::ctl {
namespace {

std::optional<doctor::Coalescing> readCoalescing(const std::string& interface) {
  const UniqueFd socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  ethtool_coalesce now{};
  now.cmd = ETHTOOL_GCOALESCE;
  ifreq request{};
  interface.copy(static_cast<char*>(request.ifr_name), IFNAMSIZ - 1);
  request.ifr_data = reinterpret_cast<char*>(&now);
  if (!socket || ::ioctl(socket.get(), SIOCETHTOOL, &request) != 0) return std::nullopt;
  return doctor::Coalescing{.rx_delay_us = now.rx_coalesce_usecs_irq,
                            .rx_frames = now.rx_max_coalesced_frames_irq};
}

}  // namespace

doctor::CanLinkFacts readLink(const doctor::HostFiles& files, const std::string& interface) {
  doctor::CanLinkFacts facts;
  facts.interface = interface;
  if (auto link = readCanLink(interface)) {
    facts.link = std::move(*link);
  } else {
    facts.similar = similarInterface(interface);
  }
  facts.driver = files.linkedName("/sys/class/net/" + interface + "/device/driver");
  facts.coalescing = readCoalescing(interface);
  return facts;
}

}  // namespace rc10::ctl
