#include "daemon/interfaces/bus_reviver.hpp"

#include <fcntl.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "bus/can_socket.hpp"

namespace rc10 {
namespace {

// None: the kernel gave no answer, which does not mean that the interface is gone.
[[nodiscard]] std::optional<CanLinkState> linkStateOf(int socket, const std::string& interface) noexcept {
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  if (::ioctl(socket, SIOCGIFFLAGS, &request) != 0)
    return errno == ENODEV || errno == ENXIO ? std::optional{CanLinkState::kGone} : std::nullopt;
  return (request.ifr_flags & IFF_UP) != 0 ? CanLinkState::kUp : CanLinkState::kDown;
}

}  // namespace

BusReviver::BusReviver(Robot& robot, std::span<BusInbox> inboxes, LinkExchange& exchange,
                       InterfaceLocks& locks)
    : robot_(robot),
      inboxes_(inboxes),
      notes_(exchange.notes, EventCode::kBusAdvice),
      locks_(locks),
      asks_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}

std::bitset<kMaxBuses> BusReviver::check(MonotonicTime now) noexcept {
  std::bitset<kMaxBuses> came_up;
  for (std::size_t i = 0; i < robot_.buses().size(); ++i) {
    const auto& entry = robot_.buses()[i];
    if (entry.interface.empty()) continue;
    auto& link = inboxes_[i].link;
    const auto told = linkStateOf(asks_.get(), entry.interface);
    if (!told) continue;
    const CanLinkState seen = *told;
    CanLinkState before = link.load(std::memory_order_relaxed);
    // A socket that lost its interface stays dead when one of that name comes back.
    if (before == CanLinkState::kGone && seen != CanLinkState::kGone && !reopen(i, now)) continue;
    // A state that a receive has stored meanwhile stays: it may be a loss that this look has missed.
    if (link.compare_exchange_strong(before, seen, std::memory_order_relaxed)) {
      came_up[i] = before != CanLinkState::kUp && seen == CanLinkState::kUp;
    }
  }
  return came_up;
}

bool BusReviver::reopen(std::size_t bus, MonotonicTime now) {
  const auto& entry = robot_.buses()[bus];
  const auto index = locks_.takeAnew(bus, entry.interface);
  if (!index) {
    // Twenty times a second the same: once is enough.
    if (std::exchange(told_[bus], index.error().message) != index.error().message)
      notes_.tell(entry.bus->name(), Severity::kError, index.error().message, now);
    return false;
  }
  told_[bus].clear();
  auto socket = openCanSocket(entry.interface, entry.options);
  if (!socket || boundInterface(socket->fd.get()) != *index) return false;
  UniqueFd echo;
  if (entry.echo) {
    auto opened = openEchoSocket(entry.interface, entry.watched);
    if (!opened || boundInterface(opened->get()) != *index) return false;
    echo = std::move(*opened);
  }
  if (::dup3(socket->fd.get(), entry.bus->descriptor(), O_CLOEXEC) < 0) return false;
  if (echo && ::dup3(echo.get(), entry.echo.get(), O_CLOEXEC) < 0) return false;
  locks_.keep(bus, *index);
  return true;
}

}  // namespace rc10
