#include "gateway/multicast_route.hpp"

#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"

namespace rc10::gateway {
namespace {

struct RouteQuery {
  nlmsghdr header{};
  rtmsg route{};
  rtattr destination{};
  in_addr group{};
};
static_assert(sizeof(RouteQuery) == NLMSG_LENGTH(sizeof(rtmsg)) + RTA_LENGTH(sizeof(in_addr)));

struct Reply {
  alignas(nlmsghdr) std::array<std::byte, 4096> bytes{};
  std::size_t size = 0;
};

// The question of `ip route get GROUP`. Returns 0 or an errno.
int ask(in_addr group, Reply& reply) {
  const UniqueFd socket{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)};
  if (!socket) return errno;
  const timeval patience{.tv_sec = 1, .tv_usec = 0};
  (void)::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  RouteQuery query;
  query.header.nlmsg_len = sizeof(query);
  query.header.nlmsg_type = RTM_GETROUTE;
  query.header.nlmsg_flags = NLM_F_REQUEST;
  query.route.rtm_family = AF_INET;
  query.route.rtm_dst_len = 32;
  query.destination.rta_type = RTA_DST;
  query.destination.rta_len = RTA_LENGTH(sizeof(in_addr));
  query.group = group;
  sockaddr_nl kernel{};
  kernel.nl_family = AF_NETLINK;
  if (::sendto(socket.get(), &query, sizeof(query), 0, reinterpret_cast<const sockaddr*>(&kernel),
               sizeof(kernel)) < 0) {
    return errno;
  }
  const ssize_t size = ::recv(socket.get(), reply.bytes.data(), reply.bytes.size(), 0);
  if (size < 0) return errno;
  reply.size = static_cast<std::size_t>(size);
  return 0;
}

template <typename Struct>
std::optional<Struct> readStruct(const Reply& reply, std::size_t offset) {
  Struct value{};
  if (offset + sizeof(value) > reply.size) return std::nullopt;
  std::memcpy(&value, reply.bytes.data() + offset, sizeof(value));
  return value;
}

// The outgoing interface in the answer; or 0 and an errno.
int outgoingInterface(const Reply& reply, int& error) {
  error = EPROTO;
  const auto header = readStruct<nlmsghdr>(reply, 0);
  if (!header) return 0;
  if (header->nlmsg_type == NLMSG_ERROR) {
    const auto failure = readStruct<nlmsgerr>(reply, NLMSG_HDRLEN);
    if (failure) error = -failure->error;
    return 0;
  }
  std::size_t at = NLMSG_LENGTH(sizeof(rtmsg));
  for (;;) {
    const auto attribute = readStruct<rtattr>(reply, at);
    if (!attribute || attribute->rta_len < sizeof(rtattr)) return 0;
    if (attribute->rta_type == RTA_OIF) return readStruct<int>(reply, at + RTA_LENGTH(0)).value_or(0);
    at += RTA_ALIGN(attribute->rta_len);
  }
}

// As if_indextoname() does, but by a socket that the sandbox has.
std::string nameOf(int interface_index) {
  const UniqueFd any{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  ifreq request{};
  request.ifr_ifindex = interface_index;
  const bool named = any && ::ioctl(any.get(), SIOCGIFNAME, &request) == 0;
  return named ? request.ifr_name : std::to_string(interface_index);
}

std::string remedy(const UdpmUrl& url) {
  return "`sudo ip route add " + url.groupText() + "/32 dev lo src 127.0.0.1`";
}

}  // namespace

bool isOwnAddress(in_addr address) {
  Reply reply;
  if (ask(address, reply) != 0) return false;
  const auto header = readStruct<nlmsghdr>(reply, 0);
  const auto route = readStruct<rtmsg>(reply, NLMSG_HDRLEN);
  return header && route && header->nlmsg_type == RTM_NEWROUTE && route->rtm_type == RTN_LOCAL;
}

Result<MulticastRoute> findRoute(const UdpmUrl& url) {
  Reply reply;
  int error = ask(url.group, reply);
  MulticastRoute route;
  if (error == 0) route.interface_index = outgoingInterface(reply, error);
  if (route.interface_index <= 0) {
    if (error == ENETUNREACH || error == EHOSTUNREACH) {
      return fail("there is no route to LCM's multicast group " + url.groupText() + ": " + remedy(url) +
                  " makes one on this computer");
    }
    return fail("cannot ask the kernel for the route to " + url.groupText() + ": " + errnoText(error));
  }
  route.interface = nameOf(route.interface_index);
  route.loopback = route.interface == "lo";
  return route;
}

Result<void> checkRoute(const UdpmUrl& url, const MulticastRoute& route) {
  if (url.ttl > 0 || route.loopback) return {};
  return fail(
      "the route to LCM's multicast group " + url.groupText() + " leaves by " + route.interface +
      ", where the neighbours can send commands too, although ttl=0 says this computer only: " + remedy(url));
}

}  // namespace rc10::gateway
