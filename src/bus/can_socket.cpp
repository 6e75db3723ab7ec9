#include "bus/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/errno_text.hpp"
#include "bus/can_link_state.hpp"
#include "bus/interface_names.hpp"

namespace rc10 {
namespace {

// State changes and lost frames. Not the errors of single frames (PROT, ACK, BUSERROR, LOSTARB): with bus
// error reporting on they come as often as frames do, and a lone node floods. And not CNT: the kernel
// delivers a message that has any bit of the filter, and those carry counters too; state changes bring
// theirs along unasked.
constexpr can_err_mask_t kErrorClasses =
    CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_TRX | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;

// Memory that the kernel charges for a frame in flight: struct sk_buff, skb_shared_info and a small buffer,
// 640 to 1000 bytes on 64-bit kernels from 5.15 to 6.18, classic or FD. Too high a figure allows half a tick
// more in flight; too low a one would refuse the last frame of every tick on an idle bus.
constexpr int kBytesPerFrameInFlight = 1024;

// About 60 ms of a full 1 Mbit/s bus, so that a late thread loses nothing.
constexpr int kReceiveBufferBytes = 512 * 1024;

struct Interface {
  int index = 0;
  int mtu = 0;
};

Result<UniqueFd> createSocket(const std::string& interface) {
  if (interface.empty() || interface.size() >= IFNAMSIZ) {
    return fail("'" + interface + "' is no interface name: it has 1 to " + std::to_string(IFNAMSIZ - 1) +
                " characters");
  }
  UniqueFd fd{::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)};
  if (fd) return fd;
  const std::string place = "CAN interface '" + interface + "': ";
  if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
    return fail(place + "this kernel has no SocketCAN, or the service may not use it (" + errnoText(errno) +
                "); use `type: sim`, or load it with `modprobe can-raw`, or allow AF_CAN in the unit's "
                "RestrictAddressFamilies=");
  }
  return fail(place + "cannot open a CAN socket: " + errnoText(errno));
}

Result<Interface> findInterface(int fd, const std::string& name) {
  ifreq request{};
  std::copy(name.begin(), name.end(), std::begin(request.ifr_name));
  Interface found;
  if (::ioctl(fd, SIOCGIFINDEX, &request) != 0) {
    const std::string reason = errnoText(errno);
    return fail("CAN interface '" + name + "': " + reason + adviceForMissing(name) +
                "; a virtual interface is made with `ip link add dev " + name +
                " type vcan && ip link set up " + name + "`");
  }
  found.index = request.ifr_ifindex;
  if (::ioctl(fd, SIOCGIFMTU, &request) != 0) {
    return canLinkFailure(name, "read its MTU", errno);
  }
  found.mtu = request.ifr_mtu;
  return found;
}

template <typename T>
bool setOption(int fd, int level, int option, const T& value) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  return ::setsockopt(fd, level, option, &value, sizeof(value)) == 0;
}

Result<void> bindTo(int fd, const std::string& name, const Interface& interface) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = interface.index;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return {};
  if (errno == ENODEV) return fail("'" + name + "' is not a CAN interface");
  return canLinkFailure(name, "bind", errno);
}

enum class Reading : std::uint8_t { kFrames, kEchoes };

// FD frames where the interface has them; for frames that are read, receive stamps and the count of drops.
Result<void> setReceiveOptions(int fd, const std::string& name, bool fd_frames, Reading reading) {
  const int on = 1;
  const bool stamped = reading == Reading::kEchoes || (setOption(fd, SOL_SOCKET, SO_TIMESTAMPNS, on) &&
                                                       setOption(fd, SOL_SOCKET, SO_RXQ_OVFL, on));
  if (!stamped || (fd_frames && !setOption(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on))) {
    return canLinkFailure(name, "set a socket option", errno);
  }
  // FORCE passes net.core.rmem_max but needs CAP_NET_ADMIN. A smaller buffer than asked is no error: what
  // it loses is counted.
  if (!setOption(fd, SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBufferBytes)) {
    (void)setOption(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBufferBytes);
  }
  return {};
}

bool hearOnly(int fd, std::span<const CanId> ids) {
  // With exactly this mask the kernel finds the socket by direct index or hash, not in a list.
  std::vector<can_filter> filters;
  for (const CanId id : ids) {
    filters.push_back(
        {id.value | (id.extended ? CAN_EFF_FLAG : 0U), CAN_EFF_FLAG | CAN_RTR_FLAG | idMask(id.extended)});
  }
  const auto size = static_cast<socklen_t>(filters.size() * sizeof(can_filter));
  return ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), size) == 0;
}

Result<int> setSendBuffer(int fd, const std::string& name, int frames_per_tick) {
  int effective = 0;
  socklen_t size = sizeof(effective);
  if (!setOption(fd, SOL_SOCKET, SO_SNDBUF, sendBufferRequest(frames_per_tick)) ||
      ::getsockopt(fd, SOL_SOCKET, SO_SNDBUF, &effective, &size) != 0) {
    return canLinkFailure(name, "set the send buffer", errno);
  }
  return effective;
}

}  // namespace

int sendBufferRequest(int frames_per_tick) noexcept {
  // The kernel doubles what is asked, and has a minimum of about 4600 bytes: 6 or 7 frames.
  return std::clamp(frames_per_tick, 1, 256) * kBytesPerFrameInFlight / 2;
}

Result<CanSocket> openCanSocket(const std::string& interface, const CanSocketOptions& options) {
  auto fd = createSocket(interface);
  if (!fd) return tl::unexpected(fd.error());
  const auto found = findInterface(fd->get(), interface);
  if (!found) return tl::unexpected(found.error());
  const bool fd_frames = found->mtu >= static_cast<int>(CANFD_MTU);
  if (auto ok = setReceiveOptions(fd->get(), interface, fd_frames, Reading::kFrames); !ok)
    return tl::unexpected(ok.error());
  if (options.send_only && ::setsockopt(fd->get(), SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0) != 0) {
    return canLinkFailure(interface, "set the filter", errno);
  }
  const can_err_mask_t errors = options.send_only ? 0U : kErrorClasses;
  if (!setOption(fd->get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors)) {
    return canLinkFailure(interface, "ask for error messages", errno);
  }
  const auto send_buffer_bytes = setSendBuffer(fd->get(), interface, options.frames_per_tick);
  if (!send_buffer_bytes) return tl::unexpected(send_buffer_bytes.error());
  if (auto ok = bindTo(fd->get(), interface, *found); !ok) return tl::unexpected(ok.error());
  return CanSocket{std::move(*fd), fd_frames, *send_buffer_bytes};
}

Result<int> findCanInterface(const std::string& interface) {
  const auto fd = createSocket(interface);
  if (!fd) return tl::unexpected(fd.error());
  const auto found = findInterface(fd->get(), interface);
  if (!found) return tl::unexpected(found.error());
  return found->index;
}

int boundInterface(int fd) noexcept {
  sockaddr_can address{};
  socklen_t size = sizeof(address);
  const bool known = ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  return known && address.can_family == AF_CAN ? address.can_ifindex : 0;
}

bool hearOwnFrames(int fd, std::span<const CanId> ids) {
  const int on = 1;
  return setOption(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, on) && hearOnly(fd, ids);
}

Result<UniqueFd> openEchoSocket(const std::string& interface, std::span<const CanId> command_ids) {
  auto fd = createSocket(interface);
  if (!fd) return tl::unexpected(fd.error());
  const auto found = findInterface(fd->get(), interface);
  if (!found) return tl::unexpected(found.error());
  const bool fd_frames = found->mtu >= static_cast<int>(CANFD_MTU);
  if (auto ok = setReceiveOptions(fd->get(), interface, fd_frames, Reading::kEchoes); !ok)
    return tl::unexpected(ok.error());
  if (!hearOnly(fd->get(), command_ids)) {
    return canLinkFailure(interface, "set the echo filter", errno);
  }
  if (auto ok = bindTo(fd->get(), interface, *found); !ok) return tl::unexpected(ok.error());
  return fd;
}

}  // namespace rc10
