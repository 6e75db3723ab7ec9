#include "can_link_watch.hpp"

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>

namespace rc10 {
namespace {

// One interface has some 2 KiB.
constexpr std::size_t kDatagram = 32768;

tl::unexpected<Error> cannotListen(int error) {
  return fail(std::string("cannot hear of interfaces that come up (rtnetlink): ") + std::strerror(error) +
              "; a unit needs RestrictAddressFamilies=AF_NETLINK");
}

}  // namespace

Result<CanLinkWatch> CanLinkWatch::open() {
  UniqueFd fd{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE)};
  if (!fd) return cannotListen(errno);
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = RTMGRP_LINK;
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return cannotListen(errno);
  }
  return CanLinkWatch{std::move(fd)};
}

Result<CanLinkWatch::News> CanLinkWatch::read() const {
  std::array<std::byte, kDatagram> datagram;
  News news;
  for (;;) {
    const auto received = ::recv(fd_.get(), datagram.data(), datagram.size(), MSG_TRUNC);
    if (received < 0) {
      if (errno == EAGAIN) return news;
      if (errno == EINTR) continue;
      if (errno != ENOBUFS) return cannotListen(errno);
      news.lost = true;
      continue;
    }
    const auto size = static_cast<std::size_t>(received);
    if (size > datagram.size()) {
      news.lost = true;
      continue;
    }
    const auto links = parseLinkNews(std::span(datagram).first(size));
    news.links.insert(news.links.end(), links.begin(), links.end());
  }
}

}  // namespace rc10
