#include "link/estop_datagram.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "link/link_protocol.hpp"
#include "link/run_dir.hpp"
#include "link/unix_address.hpp"

namespace rc10::link {

EstopDatagram EstopDatagram::to(const std::string& socket_path) noexcept {
  const auto address = unixAddress(estopPath(socket_path));
  if (!address) return EstopDatagram{{}};
  UniqueFd socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    socket.reset();
  return EstopDatagram{std::move(socket)};
}

bool EstopDatagram::send(std::string_view client) const noexcept {
  if (!socket_) return false;
  const auto name = client.substr(0, sizeof(Name));
  const ssize_t sent = ::send(socket_.get(), name.data(), name.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  // A full queue holds e-stops.
  return sent >= 0 || errno == EAGAIN || errno == ENOBUFS;
}

}  // namespace rc10::link
