#include "gateway/udpm_socket.hpp"

#include <linux/filter.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>

#include "app/errno_text.hpp"
#include "gateway/channel_filter.hpp"

namespace rc10::gateway {
namespace {

tl::unexpected<Error> socketFailed(const char* what, const UdpmUrl& url) {
  const int error = errno;
  return fail(std::string("LCM on ") + url.groupText() + ":" + std::to_string(url.port) + ": " + what + ": " +
              errnoText(error));
}

template <typename Value>
bool set(int socket, int level, int option, const Value& value) noexcept {
  return ::setsockopt(socket, level, option, &value, sizeof(value)) == 0;
}

sockaddr_in addressOf(const UdpmUrl& url) noexcept {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = url.group;
  address.sin_port = htons(url.port);
  return address;
}

UniqueFd udpSocket() noexcept {
  return UniqueFd{::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
}

Result<UniqueFd> openReceiver(const UdpmUrl& url, const MulticastRoute& route,
                              const std::vector<std::string>& channels) {
  auto socket = udpSocket();
  if (!socket) return socketFailed("socket", url);
  const int fd = socket.get();
  auto filter = channelFilter(channels);
  const sock_fprog program{.len = static_cast<unsigned short>(filter.size()), .filter = filter.data()};
  // Everything is in place before bind(): no datagram comes in without filter or stamp.
  if (!set(fd, SOL_SOCKET, SO_ATTACH_FILTER, program)) return socketFailed("channel filter", url);
  if (!set(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1)) return socketFailed("receive stamps", url);
  if (!set(fd, SOL_SOCKET, SO_REUSEADDR, 1)) return socketFailed("share the port", url);
  if (url.recv_buf_size > 0) (void)set(fd, SOL_SOCKET, SO_RCVBUF, url.recv_buf_size);
  // Only what comes in by the interface that was joined, not what other programs have joined elsewhere.
  if (!set(fd, IPPROTO_IP, IP_MULTICAST_ALL, 0)) return socketFailed("IP_MULTICAST_ALL", url);
  // Bound to the group, not to any address: liblcm's socket takes unicast from the whole network.
  const auto address = addressOf(url);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
    return socketFailed("bind", url);
  ip_mreqn membership{};
  membership.imr_multiaddr = url.group;
  membership.imr_ifindex = route.interface_index;
  if (!set(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership)) return socketFailed("join the group", url);
  return socket;
}

std::optional<Duration> stampOf(msghdr& message) noexcept {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(part), sizeof(stamp));
    return std::chrono::seconds{stamp.tv_sec} + std::chrono::nanoseconds{stamp.tv_nsec};
  }
  return std::nullopt;
}

iovec vectorOf(std::span<const std::byte> bytes) noexcept {
  // sendmsg() takes its bytes as not const but leaves them alone.
  return {const_cast<std::byte*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<UdpmSocket> UdpmSocket::open(const UdpmUrl& url, const MulticastRoute& route,
                                    const std::vector<std::string>& channels) {
  auto in = openReceiver(url, route, channels);
  if (!in) return tl::unexpected(in.error());
  auto out = udpSocket();
  if (!out) return socketFailed("socket", url);
  if (!set(out.get(), IPPROTO_IP, IP_MULTICAST_TTL, url.ttl)) return socketFailed("ttl", url);
  if (!set(out.get(), IPPROTO_IP, IP_MULTICAST_LOOP, 1)) return socketFailed("IP_MULTICAST_LOOP", url);
  ip_mreqn way{};
  way.imr_ifindex = route.interface_index;
  if (!set(out.get(), IPPROTO_IP, IP_MULTICAST_IF, way)) return socketFailed("choose the interface", url);
  return UdpmSocket{std::move(*in), std::move(out), url};
}

std::optional<UdpmSocket::Incoming> UdpmSocket::receive(std::span<std::byte> buffer) noexcept {
  for (;;) {
    iovec data{buffer.data(), buffer.size()};
    alignas(cmsghdr) std::array<std::byte, 128> control{};
    sockaddr_in sender{};
    msghdr message{};
    message.msg_name = &sender;
    message.msg_namelen = sizeof(sender);
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = ::recvmsg(in_.get(), &message, 0);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return std::nullopt;
    Incoming incoming;
    incoming.stamp = stampOf(message);
    incoming.sender = sender.sin_addr;
    incoming.datagram = parseDatagram(buffer.first(static_cast<std::size_t>(size)));
    return incoming;
  }
}

bool UdpmSocket::publish(std::string_view channel, std::span<const std::byte> bytes) noexcept {
  if (channel.size() > kMaxChannelLength || channel.size() + 1 + bytes.size() > kMaxPayload) return false;
  static constexpr std::byte kTerminator{0};
  const auto header = shortHeader(sequence_++);
  std::array<iovec, 4> parts{vectorOf(header), vectorOf(std::as_bytes(std::span{channel})),
                             vectorOf({&kTerminator, 1}), vectorOf(bytes)};
  auto address = addressOf(url_);
  msghdr message{};
  message.msg_name = &address;
  message.msg_namelen = sizeof(address);
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  return ::sendmsg(out_.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0;
}

}  // namespace rc10::gateway
