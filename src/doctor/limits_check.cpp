#include "doctor/limits_check.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "app/guard_priority.hpp"

namespace rc10::doctor {
namespace {

// rc10d locks 14 MiB with seven motors (docs/performance.md); twice that, and the recording.
constexpr long long kLockedBytes = 64LL << 20;

constexpr unsigned kCapIpcLock = 14;  // linux/capability.h
constexpr unsigned kCapSysNice = 23;

std::optional<long long> softLimit(const std::string& limits, const std::string& name) {
  const auto at = limits.find(name);
  if (at == std::string::npos) return std::nullopt;
  std::istringstream rest(limits.substr(at + name.size()));
  std::string soft;
  rest >> soft;
  if (soft == "unlimited") return LimitFacts::kUnlimited;
  long long value = 0;
  const auto [end, error] = std::from_chars(soft.data(), soft.data() + soft.size(), value);
  return error == std::errc{} ? std::optional{value} : std::nullopt;
}

bool hasCapabilities(const std::string& status) {
  const auto at = status.find("CapEff:");
  if (at == std::string::npos) return false;
  unsigned long long set = 0;
  std::istringstream(status.substr(at + 7)) >> std::hex >> set;
  return (set >> kCapIpcLock & 1U) != 0 && (set >> kCapSysNice & 1U) != 0;
}

// A line of the user's own: it counts whatever file it is in, while of those of a group the last one does,
// and the package has one in rc10d.conf; and nobody has to be in that group.
Finding tooLow(const std::string& what, const std::string& why, const LimitFacts& limits,
               const std::string& line, bool service) {
  const std::string user =
      limits.process == "self" ? "$(id -un)" : "$(stat -c %U /proc/" + limits.process + ")";
  const std::string fix = "echo \"" + user + " - " + line +
                          "\" | sudo tee -a /etc/security/limits.d/rc10.conf   # then log in again";
  if (service)
    return warn(what, why + ". The service has its own limit: only an rc10d started by hand lacks it", fix);
  return fault(what, why, fix);
}

}  // namespace

LimitFacts readLimits(const HostFiles& files, const std::string& process) {
  const auto limits = files.read("/proc/" + process + "/limits").value_or("");
  return {.process = process,
          .realtime_priority = softLimit(limits, "Max realtime priority"),
          .locked_bytes = softLimit(limits, "Max locked memory"),
          .may_anyway = hasCapabilities(files.read("/proc/" + process + "/status").value_or(""))};
}

bool serviceInstalled(const HostFiles& files) {
  for (const char* folder : {"/etc/systemd/system", "/lib/systemd/system", "/usr/lib/systemd/system",
                             "/usr/local/lib/systemd/system"}) {
    if (files.exists(std::string(folder) + "/rc10d.service")) return true;
  }
  return false;
}

Finding checkRealtimeLimit(const LimitFacts& limits, const std::string& who, bool service,
                           const PriorityNeeds& needs) {
  const std::string what = "real-time priority limit";
  if (limits.may_anyway) return pass(what, who + " has CAP_SYS_NICE");
  if (!limits.realtime_priority)
    return warn(what, "the limits of " + who + " cannot be read", "run it as the user of rc10d");
  const auto limit = *limits.realtime_priority;
  const int priority = needs.guard ? std::max(needs.rc10d, kGuardPriority) : needs.rc10d;
  if (limit == LimitFacts::kUnlimited || limit >= priority)
    return pass(what, who + " may have up to " + (limit < 0 ? "any" : std::to_string(limit)));
  return tooLow(what,
                who + " may have up to " + std::to_string(limit) + ", " +
                    (needs.rc10d < priority ? "rc10-guard" : "rc10d") + " asks for " +
                    std::to_string(priority) + " (which members of the group rc10-dev get from the package)",
                limits, "rtprio 90", service);
}

Finding checkMemoryLimit(const LimitFacts& limits, const std::string& who, bool service) {
  const std::string what = "locked memory limit";
  if (limits.may_anyway) return pass(what, who + " has CAP_IPC_LOCK");
  if (!limits.locked_bytes)
    return warn(what, "the limits of " + who + " cannot be read", "run it as the user of rc10d");
  const auto limit = *limits.locked_bytes;
  if (limit == LimitFacts::kUnlimited) return pass(what, who + " may lock all its memory");
  const std::string size = std::to_string(limit >> 20) + " MiB";
  if (limit >= kLockedBytes) return pass(what, who + " may lock " + size);
  return tooLow(what,
                who + " may lock " + size + " of memory; rc10d needs " + std::to_string(kLockedBytes >> 20) +
                    " MiB: without, its threads do not start or wait for the disk",
                limits, "memlock unlimited", service);
}

}  // namespace rc10::doctor
