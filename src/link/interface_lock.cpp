#include "link/interface_lock.hpp"

#include <net/if.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <string_view>

#include "app/errno_text.hpp"
#include "app/printable.hpp"

namespace rc10::link {
namespace {

struct AbstractAddress {
  sockaddr_un address{};
  socklen_t size = 0;
};

std::string lockName(int index) { return "rc10d-interface/" + std::to_string(index); }

// The first byte is zero: no file. A name that is too long is cut; locks are short.
AbstractAddress abstractAddress(std::string_view name) noexcept {
  AbstractAddress result;
  const auto size = std::min(name.size(), sizeof(result.address.sun_path) - 1);
  result.address.sun_family = AF_UNIX;
  std::memcpy(result.address.sun_path + 1, name.data(), size);
  result.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + size);
  return result;
}

UniqueFd datagramSocket() noexcept {
  return UniqueFd{::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
}

// A datagram socket has no queue of connections that others could fill, and this one receives nothing.
UniqueFd bindName(std::string_view name) noexcept {
  UniqueFd socket = datagramSocket();
  const auto at = abstractAddress(name);
  if (!socket || ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at.address), at.size) != 0)
    return {};
  (void)::shutdown(socket.get(), SHUT_RD);
  return socket;
}

bool isBound(std::string_view name) noexcept {
  const UniqueFd socket = datagramSocket();
  const auto at = abstractAddress(name);
  // Without descriptors it cannot be known: held, to be on the safe side.
  return !socket || ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&at.address), at.size) == 0 ||
         errno != ECONNREFUSED;
}

// The kernel lists abstract names with '@' first. Anybody may choose a name, so the words are for people
// alone.
std::string wordsOf(int index) {
  const std::string beginning = " @" + lockName(index) + "/";
  std::ifstream sockets("/proc/self/net/unix");
  for (std::string line; std::getline(sockets, line);) {
    const auto at = line.find(beginning);
    if (at != std::string::npos) return printable(line.substr(at + beginning.size()));
  }
  return "another program (`sudo ss -xap | grep " + lockName(index) + "` names it)";
}

}  // namespace

Result<InterfaceLock> InterfaceLock::take(int index, const std::string& interface, const std::string& robot) {
  UniqueFd lock = bindName(lockName(index));
  if (!lock) {
    const int error = errno;
    if (error != EADDRINUSE)
      return fail("cannot lock CAN interface '" + interface + "': " + errnoText(error));
    return fail(interface + " is driven by " + wordsOf(index) + "; stop it first");
  }
  // Names of this process alone: those of others that begin alike do not matter.
  UniqueFd words =
      bindName(lockName(index) + "/robot '" + robot + "' (rc10d, pid " + std::to_string(::getpid()) + ")");
  return InterfaceLock{index, std::move(lock), std::move(words)};
}

std::string InterfaceLock::holder(int index) { return isBound(lockName(index)) ? wordsOf(index) : ""; }

std::string holderOfInterface(const std::string& interface) {
  const auto index = ::if_nametoindex(interface.c_str());
  return index == 0 ? "" : InterfaceLock::holder(static_cast<int>(index));
}

}  // namespace rc10::link
