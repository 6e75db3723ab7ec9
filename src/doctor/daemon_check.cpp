#include "doctor/daemon_check.hpp"

#include <sstream>

namespace rc10::doctor {
namespace {

long long statusNumber(const std::string& status, const std::string& key) {
  const auto at = status.find("\n" + key);
  long long value = -1;
  if (at != std::string::npos) std::istringstream(status.substr(at + 1 + key.size())) >> value;
  return value;
}

// "0::/system.slice/rc10d.service"
std::string unitOf(const std::string& cgroup) {
  const auto slash = cgroup.rfind('/');
  const std::string name = slash == std::string::npos ? "" : cgroup.substr(slash + 1);
  const std::string ending = ".service";
  return name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0
             ? name
             : "";
}

std::string nameOf(const DaemonFacts& daemon) { return "rc10d (pid " + std::to_string(daemon.pid) + ")"; }

}  // namespace

std::vector<DaemonFacts> readDaemons(const HostFiles& files, const std::vector<Process>& processes) {
  std::vector<DaemonFacts> daemons;
  for (const auto& process : processes) {
    if (process.name != "rc10d") continue;
    const std::string folder = "/proc/" + std::to_string(process.pid);
    const auto status = files.read(folder + "/status");
    if (!status) continue;
    daemons.push_back({.pid = process.pid,
                       .root = statusNumber(*status, "Uid:") == 0,
                       .no_new_privileges = statusNumber(*status, "NoNewPrivs:") == 1,
                       .seccomp = statusNumber(*status, "Seccomp:") == 2,
                       .unit = unitOf(files.read(folder + "/cgroup").value_or(""))});
  }
  return daemons;
}

Finding checkOneDaemon(const std::vector<DaemonFacts>& daemons,
                       const std::map<std::string, std::string>& holders, const std::string& robot) {
  const std::string what = "one daemon";
  for (const auto& [interface, holder] : holders) {
    std::string why;
    if (holder.empty() || robot.empty() || holder.find("'" + robot + "'") != std::string::npos) continue;
    why.append(interface).append(" of robot '").append(robot).append("' is driven by ").append(holder);
    return fault(
        what, why,
        "stop it (`sudo systemctl stop rc10d`, or end that process), or give the robot another interface");
  }
  if (daemons.empty()) return pass(what, "none runs");
  std::string names;
  for (const auto& daemon : daemons) names.append(names.empty() ? "" : ", ").append(nameOf(daemon));
  if (daemons.size() == 1) return pass(what, names + " runs");
  return warn(what,
              std::to_string(daemons.size()) + " run: " + names +
                  ". That is right only for several robots on this computer",
              "`rc10ctl --robot NAME list` tells which is which; end the one that you do not want");
}

Finding checkSandbox(const std::vector<DaemonFacts>& daemons, bool service_installed) {
  const std::string what = "service sandbox";
  const std::string start = "sudo systemctl enable --now rc10d";
  if (daemons.empty()) {
    if (service_installed) return pass(what, "rc10d.service is installed; rc10d does not run");
    return warn(what,
                "rc10d.service is not installed: started by hand, rc10d has neither limits nor sandbox, and "
                "nobody starts it again",
                "install the package rc10d, or `sudo cmake --install build/release`; then " + start);
  }
  for (const auto& daemon : daemons) {
    if (daemon.root) return warn(what, nameOf(daemon) + " runs as root", "stop it; " + start);
    if (daemon.unit.empty())
      return warn(what, nameOf(daemon) + " was started by hand: no sandbox, no restart", "stop it; " + start);
    if (!daemon.seccomp || !daemon.no_new_privileges) {
      return warn(what, daemon.unit + " runs without the system call filter of the shipped unit",
                  "systemctl cat " + daemon.unit + "   # look for drop-ins that took it away");
    }
  }
  return pass(what, daemons.front().unit + ": system call filter, no new privileges, not root");
}

}  // namespace rc10::doctor
