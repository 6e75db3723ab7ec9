#include "doctor/process_list.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace rc10::doctor {
namespace {

constexpr int kFifo = 1;  // sched.h
constexpr int kRoundRobin = 2;
constexpr unsigned kKernelThread = 0x00200000;  // PF_KTHREAD of the kernel's sched.h

// proc(5): the name in parentheses may hold anything. After it comes field 3, the state; 9 are the kernel's
// flags, 40 is the real-time priority, 41 the policy.
bool parse(const std::string& stat, Process& process) {
  const auto open = stat.find('(');
  const auto close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close < open) return false;
  process.name = stat.substr(open + 1, close - open - 1);
  std::istringstream fields(stat.substr(close + 1));
  std::string skipped;
  for (int field = 3; field < 9; ++field) fields >> skipped;
  unsigned flags = 0;
  fields >> flags;
  for (int field = 10; field < 40; ++field) fields >> skipped;
  int policy = 0;
  if (!(fields >> process.priority >> policy)) return false;
  process.kernel = (flags & kKernelThread) != 0;
  process.fifo = policy == kFifo || policy == kRoundRobin;
  return true;
}

}  // namespace

std::vector<Process> readProcesses(const HostFiles& files) {
  std::vector<Process> processes;
  for (const auto& name : files.list("/proc")) {
    const bool pid =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    if (!pid || name.size() > 9) continue;
    Process process;
    process.pid = std::stoi(name);
    const auto stat = files.read("/proc/" + name + "/stat");  // it may have ended meanwhile
    if (stat && parse(*stat, process)) processes.push_back(process);
  }
  return processes;
}

}  // namespace rc10::doctor
