#include "daemon/exchange/estop_datagrams.hpp"

#include <sys/socket.h>

#include <array>

namespace rc10 {

std::optional<link::Name> EstopDatagrams::take() const noexcept {
  std::optional<link::Name> client;
  for (int i = 0; i < kPerLook; ++i) {
    std::array<char, sizeof(link::Name)> text{};
    const ssize_t size = ::recv(fd_, text.data(), text.size(), MSG_DONTWAIT);
    if (size < 0) break;
    // An empty datagram is an e-stop too.
    if (!client) client = link::Name{std::string_view{text.data(), static_cast<std::size_t>(size)}};
  }
  return client;
}

}  // namespace rc10
