#include "page_addresses.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <type_traits>

#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10::ctl {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Duration kPatience = std::chrono::seconds{1};
constexpr std::size_t kMostAnswer = 8192;

struct Address {
  sockaddr_storage where{};
  socklen_t size = 0;
  std::string text;  ///< As in a URL.
};

template <typename Socket>
Address withPort(Socket address, std::uint16_t port) {
  Address out;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if constexpr (std::is_same_v<Socket, sockaddr_in>) {
    address.sin_port = htons(port);
    out.text = ::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  } else {
    address.sin6_port = htons(port);
    out.text = std::string{"["} + ::inet_ntop(AF_INET6, &address.sin6_addr, text.data(), text.size()) + "]";
  }
  std::memcpy(&out.where, &address, sizeof address);
  out.size = sizeof address;
  return out;
}

bool wait(int socket, short events, Clock::time_point end) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
  pollfd entry{.fd = socket, .events = events, .revents = 0};
  return left > 0 && ::poll(&entry, 1, static_cast<int>(left)) > 0;
}

// Another program may have the port: rc10-web names itself.
bool serves(const Address& address) {
  const auto end = Clock::now() + kPatience;
  const UniqueFd socket{::socket(address.where.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (!socket) return false;
  (void)::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address.where), address.size);
  int error = 0;
  socklen_t size = sizeof error;
  if (!wait(socket.get(), POLLOUT, end) ||
      ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0)
    return false;
  const std::string request = "HEAD / HTTP/1.1\r\nHost: " + address.text + "\r\nConnection: close\r\n\r\n";
  if (::send(socket.get(), request.data(), request.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(request.size()))
    return false;
  std::string answer;
  while (answer.size() < kMostAnswer && wait(socket.get(), POLLIN, end)) {
    std::array<char, 1024> part{};
    const auto received = ::recv(socket.get(), part.data(), part.size(), 0);
    if (received <= 0) break;
    answer.append(part.data(), static_cast<std::size_t>(received));
    if (answer.find("\r\n\r\n") != std::string::npos) break;
  }
  return answer.starts_with("HTTP/1.1 ") && answer.find("\r\nServer: rc10-web\r\n") != std::string::npos;
}

// Loopback and the addresses of one cable alone are no use to a phone.
bool isForOthers(const sockaddr& address) {
  if (address.sa_family == AF_INET) {
    const auto number = ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr);
    return number >> 24U != 127 && number >> 16U != 0xa9fe;
  }
  if (address.sa_family != AF_INET6) return false;
  const auto& v6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
  return IN6_IS_ADDR_LOOPBACK(&v6) == 0 && IN6_IS_ADDR_LINKLOCAL(&v6) == 0;
}

std::vector<Address> addressesForOthers(std::uint16_t port) {
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> all{first, &::freeifaddrs};
  std::vector<Address> found;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || !isForOthers(*each->ifa_addr)) continue;
    if (each->ifa_addr->sa_family == AF_INET)
      found.push_back(withPort(reinterpret_cast<const sockaddr_in&>(*each->ifa_addr), port));
    else
      found.push_back(withPort(reinterpret_cast<const sockaddr_in6&>(*each->ifa_addr), port));
  }
  std::stable_sort(found.begin(), found.end(), [](const Address& a, const Address& b) {
    return a.where.ss_family == AF_INET && b.where.ss_family != AF_INET;
  });
  return found;
}

}  // namespace

PageAddresses findPage(std::uint16_t port) {
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sockaddr_in6 v6{};
  v6.sin6_family = AF_INET6;
  v6.sin6_addr = IN6ADDR_LOOPBACK_INIT;
  PageAddresses out;
  out.here = serves(withPort(v4, port)) || serves(withPort(v6, port));
  for (const auto& address : addressesForOthers(port)) {
    if (serves(address)) out.others.push_back(address.text);
  }
  return out;
}

}  // namespace rc10::ctl
