#include "robot_client/own_datagrams.hpp"

#include <linux/filter.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace rc10 {
inline namespace robot_client {
namespace {

// Open descriptors; without /proc none, and then nothing is kept out.
[[nodiscard]] std::vector<int> openDescriptors() {
  std::vector<int> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error))
    found.push_back(std::atoi(entry.path().filename().c_str()));
  return found;
}

template <typename T>
[[nodiscard]] T optionOf(int socket, int option) noexcept {
  T value{};
  socklen_t size = sizeof value;
  return ::getsockopt(socket, SOL_SOCKET, option, &value, &size) == 0 ? value : T{-1};
}

// By the loopback interface; or by another one, as a copy of a multicast that left by it.
void hearThisComputerOnly(int socket) noexcept {
  const unsigned loopback = ::if_nametoindex("lo");
  constexpr auto kIndex = static_cast<unsigned>(SKF_AD_OFF + SKF_AD_IFINDEX);
  constexpr auto kType = static_cast<unsigned>(SKF_AD_OFF + SKF_AD_PKTTYPE);
  std::array<sock_filter, 6> program{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kIndex),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, loopback, 2, 0),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kType),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, ~0U),
      BPF_STMT(BPF_RET | BPF_K, 0U),
  }};
  const sock_fprog filter{.len = program.size(), .filter = program.data()};
  (void)::setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter);
}

}  // namespace

bool staysOnThisComputer(const std::string& url) {
  if (!url.empty() && url.rfind("udpm://", 0) != 0) return false;
  const auto at = url.find("ttl=");
  return at == std::string::npos || std::atoi(url.c_str() + at + 4) == 0;
}

OwnDatagrams::OwnDatagrams() : before_(openDescriptors()) {}

void OwnDatagrams::keepOut(const std::string& url) const {
  if (!staysOnThisComputer(url)) return;
  for (const int descriptor : openDescriptors()) {
    if (std::find(before_.begin(), before_.end(), descriptor) != before_.end()) continue;
    if (optionOf<int>(descriptor, SO_DOMAIN) == AF_INET && optionOf<int>(descriptor, SO_TYPE) == SOCK_DGRAM)
      hearThisComputerOnly(descriptor);
  }
}

}  // namespace robot_client
}  // namespace rc10
