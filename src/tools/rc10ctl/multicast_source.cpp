#include "multicast_source.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstring>

#include "app/unique_fd.hpp"

namespace rc10::ctl {

// Connecting a datagram socket sends nothing: the kernel looks up the route and takes its source.
std::optional<doctor::Ipv4> multicastSource(const doctor::Ipv4& group) {
  const UniqueFd socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(1);  // any
  std::memcpy(&address.sin_addr, group.data(), group.size());
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (!socket || ::connect(socket.get(), generic, size) != 0) return std::nullopt;
  if (::getsockname(socket.get(), generic, &size) != 0) return std::nullopt;
  doctor::Ipv4 source{};
  std::memcpy(source.data(), &address.sin_addr, source.size());
  return source;
}

}  // namespace rc10::ctl
