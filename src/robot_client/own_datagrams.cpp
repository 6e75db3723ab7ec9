#include "robot_client/own_datagrams.hpp"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace rc10 {
inline namespace robot_client {
namespace {

using Program = std::vector<sock_filter>;

// Offsets from the UDP header on. LCM's own: 8 bytes, or 20 of a message in fragments, the first of which has
// the channel.
constexpr std::uint32_t kMagic = 8;
constexpr std::uint32_t kChannel = 16;
constexpr std::uint32_t kFragmentNumber = 24;
constexpr std::uint32_t kChannelOfFragments = 28;
constexpr std::uint32_t kFragments = 0x4c433033;  // "LC03"

constexpr sock_filter kAccept = BPF_STMT(BPF_RET | BPF_K, ~0U);
constexpr sock_filter kDrop = BPF_STMT(BPF_RET | BPF_K, 0U);

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

void attach(int socket, Program& program) noexcept {
  const sock_fprog filter{.len = static_cast<unsigned short>(program.size()), .filter = program.data()};
  (void)::setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter);
}

// Datagrams that were sent on this computer go on to `then`; all others behind it. They come by the loopback
// interface, or by another one, as copies of a multicast that left by it.
void ifOwn(Program& program, const Program& then) {
  constexpr auto kIndex = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_IFINDEX);
  constexpr auto kType = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_PKTTYPE);
  const auto length = static_cast<std::uint8_t>(then.size());
  program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kIndex));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ::if_nametoindex("lo"), 2, 0));
  program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kType));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 0, length));
  program.insert(program.end(), then.begin(), then.end());
}

// Ends with `match` where these bytes stand; goes on behind where they do not. In order: a load beyond the
// end of a datagram drops it.
[[nodiscard]] Program ifBytes(std::string_view bytes, std::uint32_t offset, const sock_filter& match) {
  Program program;
  struct Load {
    std::uint16_t size;
    std::uint32_t offset;
    std::uint32_t value;
  };
  std::vector<Load> loads;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = bytes.size() - at >= 4 ? 4 : 1;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8U | static_cast<std::uint8_t>(bytes[at + i]);
    loads.push_back({static_cast<std::uint16_t>(size == 4 ? BPF_W : BPF_B),
                     offset + static_cast<std::uint32_t>(at), value});
    at += size;
  }
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const auto behind = static_cast<std::uint8_t>(2 * (loads.size() - 1 - i) + 1);
    program.push_back(
        BPF_STMT(static_cast<std::uint16_t>(BPF_LD | BPF_ABS | loads[i].size), loads[i].offset));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, loads[i].value, 0, behind));
  }
  program.push_back(match);
  return program;
}

[[nodiscard]] sockaddr_in addressOf(const std::string& url) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);
  address.sin_addr.s_addr = ::inet_addr("239.255.76.67");
  constexpr std::string_view kScheme = "udpm://";
  const auto place = url.substr(kScheme.size(), url.find('?') - kScheme.size());
  const auto colon = place.find(':');
  if (in_addr group{}; ::inet_aton(place.substr(0, colon).c_str(), &group) != 0) address.sin_addr = group;
  if (colon != std::string::npos)
    address.sin_port = htons(static_cast<std::uint16_t>(std::atoi(place.c_str() + colon + 1)));
  return address;
}

}  // namespace

bool staysOnThisComputer(const std::string& url) {
  if (!url.empty() && url.rfind("udpm://", 0) != 0) return false;
  const auto at = url.find("ttl=");
  return at == std::string::npos || std::atoi(url.c_str() + at + 4) == 0;
}

OwnDatagrams::OwnDatagrams() : before_(openDescriptors()) {}

void OwnDatagrams::keepOut(const std::string& url) {
  if (!url.empty() && url.rfind("udpm://", 0) != 0) return;
  url_ = url;
  for (const int descriptor : openDescriptors()) {
    if (std::find(before_.begin(), before_.end(), descriptor) != before_.end()) continue;
    if (optionOf<int>(descriptor, SO_DOMAIN) == AF_INET && optionOf<int>(descriptor, SO_TYPE) == SOCK_DGRAM)
      sockets_.push_back(descriptor);
  }
  const int by_others = 0;  // not what other programs have joined at other interfaces
  for (const int socket : sockets_)
    (void)::setsockopt(socket, IPPROTO_IP, IP_MULTICAST_ALL, &by_others, sizeof by_others);
  filter();
}

void OwnDatagrams::filter() const {
  Program program;
  ifOwn(program, {kAccept});
  if (!staysOnThisComputer(url_)) {
    // To a group: the first byte of the address is 224 or more.
    program.push_back(BPF_STMT(BPF_LD | BPF_B | BPF_ABS, static_cast<std::uint32_t>(SKF_NET_OFF + 16)));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 224, 1, 0));
    program.push_back(kDrop);
    for (const auto& beginning : here_) {
      const auto fragments = ifBytes(beginning, kChannelOfFragments, kDrop);
      const auto whole = ifBytes(beginning, kChannel, kDrop);
      const auto length = static_cast<std::uint8_t>(fragments.size());
      program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kMagic));
      program.push_back(
          BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kFragments, 0, static_cast<std::uint8_t>(length + 2)));
      program.push_back(BPF_STMT(BPF_LD | BPF_H | BPF_ABS, kFragmentNumber));
      program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 0, length));
      program.insert(program.end(), fragments.begin(), fragments.end());
      program.insert(program.end(), whole.begin(), whole.end());
    }
    program.push_back(kAccept);
  } else {
    program.push_back(kDrop);
  }
  for (const int socket : sockets_) attach(socket, program);
}

UniqueFd OwnDatagrams::witnessOf(std::string_view robot) const {
  const auto beginning = std::string{robot} + ".v1.";
  if (sockets_.empty() || staysOnThisComputer(url_) ||
      std::find(here_.begin(), here_.end(), beginning) != here_.end())
    return {};
  UniqueFd witness{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  Program program;
  using namespace std::string_literals;
  ifOwn(program, ifBytes(beginning + "state\0"s, kChannel, kAccept));
  program.push_back(kDrop);
  attach(witness.get(), program);
  const int shared = 1;
  const auto address = addressOf(url_);
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  (void)::setsockopt(witness.get(), SOL_SOCKET, SO_REUSEADDR, &shared, sizeof shared);
  if (::bind(witness.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::setsockopt(witness.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0)
    return {};
  return witness;
}

void OwnDatagrams::isHere(std::string_view robot) {
  here_.push_back(std::string{robot} + ".v1.");
  filter();
}

}  // namespace robot_client
}  // namespace rc10
