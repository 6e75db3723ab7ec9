#include "doctor/multicast_check.hpp"

#include <arpa/inet.h>

#include <cstring>
#include <sstream>

namespace rc10::doctor {
namespace {

constexpr unsigned kRouteUp = 1;  // RTF_UP
constexpr unsigned kRouteReject = 0x200;

constexpr std::uint8_t kLoopbackNet = 127;

std::string textOf(const Ipv4& ipv4) {
  std::string text;
  for (const auto byte : ipv4) text += (text.empty() ? "" : ".") + std::to_string(byte);
  return text;
}

}  // namespace

std::string routeOf(const HostFiles& files, const Ipv4& group) {
  std::uint32_t wanted = 0;  // as the file has it: in the order of the network, read as a number of the host
  std::memcpy(&wanted, group.data(), sizeof wanted);
  std::istringstream lines(files.read("/proc/net/route").value_or(""));
  std::string best;
  std::uint32_t best_mask = 0;
  std::string line;
  std::getline(lines, line);  // titles
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string interface;
    std::uint32_t destination = 0;
    std::uint32_t gateway = 0;
    std::uint32_t mask = 0;
    unsigned flags = 0;
    std::string skipped;
    fields >> interface >> std::hex >> destination >> gateway >> flags >> skipped >> skipped >> skipped >>
        mask;
    if (!fields || (flags & kRouteUp) == 0 || (flags & kRouteReject) != 0) continue;
    if ((wanted & mask) != destination) continue;
    // The longest mask decides, then the first line.
    if (best.empty() || ntohl(mask) > ntohl(best_mask)) {
      best = interface;
      best_mask = mask;
    }
  }
  return best;
}

Finding checkMulticast(const std::string& interface, const std::optional<Ipv4>& source, const Ipv4& group,
                       int ttl) {
  const std::string what = "multicast route";
  const std::string address = textOf(group);
  // The source: the service's filter takes no other, and the kernel would prefer that of Ethernet or Wi-Fi.
  const std::string fix = "sudo ip route replace " + address + "/32 dev lo src 127.0.0.1";
  if (interface.empty()) {
    return fault(
        what,
        "none for " + address + ": no LCM message is sent or received. The service makes it (ExecStartPre)",
        fix);
  }
  if (ttl > 0) return pass(what, address + " by " + interface + ", ttl " + std::to_string(ttl));
  if (interface == "lo" && source && source->front() != kLoopbackNet) {
    return warn(what,
                address + " stays on this computer, but comes from " + textOf(*source) +
                    ": the filter of the service drops it, and no command arrives",
                fix);
  }
  if (interface == "lo") return pass(what, address + " stays on this computer");
  return warn(
      what,
      address + " goes by " + interface +
          ": LCM falls silent when that network changes. The service makes a route of its own (ExecStartPre)",
      fix);
}

}  // namespace rc10::doctor
