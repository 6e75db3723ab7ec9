#pragma once

#include <map>
#include <string>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/host_files.hpp"
#include "doctor/process_list.hpp"

namespace rc10::doctor {

/// One running rc10d.
struct DaemonFacts {
  int pid = 0;
  bool root = false;
  bool no_new_privileges = false;
  bool seccomp = false;
  std::string unit;  ///< "rc10d.service"; empty: no service of systemd.
};

[[nodiscard]] std::vector<DaemonFacts> readDaemons(const HostFiles& files,
                                                   const std::vector<Process>& processes);

/// `holders`: who drives which interface (InterfaceLock::holder()); `robot`: the one of the configuration,
/// may be empty.
[[nodiscard]] Finding checkOneDaemon(const std::vector<DaemonFacts>& daemons,
                                     const std::map<std::string, std::string>& holders,
                                     const std::string& robot);

/// Whether rc10d runs as the service with its sandbox.
[[nodiscard]] Finding checkSandbox(const std::vector<DaemonFacts>& daemons, bool service_installed);

}  // namespace rc10::doctor
