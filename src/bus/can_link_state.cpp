#include "bus/can_link_state.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <span>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"
#include "bus/interface_names.hpp"
#include "bus/netlink_attributes.hpp"

// Not by libsocketcan: can_get_state() of 0.0.12 waits for ever when the interface vanishes meanwhile (it
// skips the kernel's error answer), and writes to stderr what vcan lacks.

namespace rc10 {
namespace {

using netlink::attribute;
using netlink::Bytes;
using netlink::readAs;
using netlink::text;

/// Both rates and sample points of a controller, where they were set.
void readTiming(Bytes can, CanLink& link) {
  if (const auto timing = readAs<can_bittiming>(attribute(can, IFLA_CAN_BITTIMING));
      timing && timing->bitrate != 0) {
    link.bitrate = timing->bitrate;
    link.sample_point = static_cast<double>(timing->sample_point) / 1000.0;
  }
  if (const auto timing = readAs<can_bittiming>(attribute(can, IFLA_CAN_DATA_BITTIMING));
      timing && timing->bitrate != 0) {
    link.data_bitrate = timing->bitrate;
    link.data_sample_point = static_cast<double>(timing->sample_point) / 1000.0;
  }
}

[[nodiscard]] CanState stateOf(std::uint32_t state) noexcept {
  switch (state) {
    case CAN_STATE_ERROR_ACTIVE: return CanState::kActive;
    case CAN_STATE_ERROR_WARNING: return CanState::kWarning;
    case CAN_STATE_ERROR_PASSIVE: return CanState::kPassive;
    case CAN_STATE_BUS_OFF: return CanState::kBusOff;
    default: return CanState::kStopped;
  }
}

void readController(Bytes can, CanLink& link) {
  readTiming(can, link);
  link.restart_ms = readAs<std::uint32_t>(attribute(can, IFLA_CAN_RESTART_MS)).value_or(0);
  if (const auto state = readAs<std::uint32_t>(attribute(can, IFLA_CAN_STATE))) {
    link.bus_off = *state == CAN_STATE_BUS_OFF;
    link.state = stateOf(*state);
  }
  if (const auto mode = readAs<can_ctrlmode>(attribute(can, IFLA_CAN_CTRLMODE))) {
    link.fd_on = (mode->flags & CAN_CTRLMODE_FD) != 0;
    link.modes = mode->flags;
  }
  if (const auto counter = readAs<can_berr_counter>(attribute(can, IFLA_CAN_BERR_COUNTER))) {
    link.tec = counter->txerr;
    link.rec = counter->rxerr;
  }
}

[[nodiscard]] CanLink parse(const ifinfomsg& info, Bytes attributes) {
  CanLink link;
  link.up = (info.ifi_flags & IFF_UP) != 0;
  link.is_can = info.ifi_type == ARPHRD_CAN;
  link.qdisc = text(attribute(attributes, IFLA_QDISC));
  link.queue_length = readAs<std::uint32_t>(attribute(attributes, IFLA_TXQLEN)).value_or(0);
  if (const auto stats = readAs<rtnl_link_stats64>(attribute(attributes, IFLA_STATS64))) {
    link.rx_lost = stats->rx_dropped + stats->rx_over_errors + stats->rx_fifo_errors;
  }
  const auto link_info = attribute(attributes, IFLA_LINKINFO);
  link.kind = text(attribute(link_info, IFLA_INFO_KIND));
  if (!link.isController()) return link;
  readController(attribute(link_info, IFLA_INFO_DATA), link);
  if (const auto stats = readAs<can_device_stats>(attribute(link_info, IFLA_INFO_XSTATS))) {
    link.bus_errors = stats->bus_error;
    link.times_passive = stats->error_passive;
    link.times_bus_off = stats->bus_off;
  }
  return link;
}

/// Sends the request and returns the kernel's answer, or errno.
[[nodiscard]] int ask(const std::string& interface, std::span<std::byte> answer, std::size_t& size) noexcept {
  struct {
    nlmsghdr header;
    ifinfomsg info;
    rtattr name_header;
    std::array<char, IFNAMSIZ> name;
  } request{};
  const UniqueFd fd{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)};
  if (!fd) return errno;
  const timeval patience{.tv_sec = 1, .tv_usec = 0};
  ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.name_header = {.rta_len = RTA_LENGTH(IFNAMSIZ), .rta_type = IFLA_IFNAME};
  interface.copy(request.name.data(), request.name.size() - 1);
  if (::send(fd.get(), &request, sizeof request, 0) < 0) return errno;
  const auto received = ::recv(fd.get(), answer.data(), answer.size(), 0);
  if (received < 0) return errno;
  size = static_cast<std::size_t>(received);
  return 0;
}

}  // namespace

tl::unexpected<Error> canLinkFailure(const std::string& interface, const std::string& what, int error,
                                     const std::string& fix) {
  const auto remedy = error == ENODEV ? adviceForMissing(interface) : fix;
  return fail("CAN interface '" + interface + "': cannot " + what + ": " + errnoText(error) + remedy);
}

Result<CanLink> readCanLink(const std::string& interface) {
  const std::string what = "ask for its state";
  std::array<std::byte, 16384> answer;
  std::size_t size = 0;
  if (const int error = ask(interface, answer, size); error != 0)
    return canLinkFailure(interface, what, error);
  const auto bytes = Bytes(answer).first(size);
  const auto header = readAs<nlmsghdr>(bytes);
  if (!header || header->nlmsg_len < sizeof(nlmsghdr) || header->nlmsg_len > size) {
    return canLinkFailure(interface, what, EBADMSG);
  }
  const auto payload = bytes.first(header->nlmsg_len).subspan(sizeof(nlmsghdr));
  if (header->nlmsg_type == NLMSG_ERROR) {
    return canLinkFailure(interface, what,
                          -readAs<int>(payload).value_or(-EBADMSG));  // nlmsgerr begins with it
  }
  const auto info = readAs<ifinfomsg>(payload);
  if (header->nlmsg_type != RTM_NEWLINK || !info) return canLinkFailure(interface, what, EBADMSG);
  return parse(*info, payload.subspan(sizeof(ifinfomsg)));
}

}  // namespace rc10
