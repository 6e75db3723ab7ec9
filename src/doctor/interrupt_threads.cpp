#include "doctor/interrupt_threads.hpp"

#include <net/if.h>
#include <net/if_arp.h>

#include <algorithm>
#include <cstdlib>

namespace rc10::doctor {
namespace {

// Length of a name in kernels before 5.17.
constexpr std::size_t kCutName = 15;

bool isNumber(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// "irq/57-spi0.0" or, of a name that was too long, "irq/161-mcp2515"(cut).
bool serves(const Process& process, const std::string& name) {
  const auto dash = process.name.find('-');
  if (name.empty() || dash == std::string::npos || process.name.rfind("irq/", 0) != 0) return false;
  const std::string device = process.name.substr(dash + 1);
  return device == name || (process.name.size() == kCutName && name.rfind(device, 0) == 0) ||
         // The second thread of an interrupt: "irq/57-s-spi0.0".
         device == "s-" + name;
}

// The thread that moves the bytes of "spi0.1" is "spi0".
std::string spiController(const std::string& device) {
  const auto dot = device.find('.');
  if (device.rfind("spi", 0) != 0 || dot == std::string::npos || !isNumber(device.substr(3, dot - 3)))
    return {};
  return device.substr(0, dot);
}

bool isDown(const std::string& interface, const HostFiles& files) {
  const auto flags = files.read("/sys/class/net/" + interface + "/flags");  // "0x1003"
  return flags && (std::strtoul(flags->c_str(), nullptr, 16) & IFF_UP) == 0;
}

}  // namespace

std::vector<std::string> canInterfaces(const HostFiles& files) {
  std::vector<std::string> interfaces;
  for (const auto& name : files.list("/sys/class/net")) {
    if (files.number("/sys/class/net/" + name + "/type") == ARPHRD_CAN) interfaces.push_back(name);
  }
  return interfaces;
}

std::vector<Process> threadsOf(const std::string& interface, const HostFiles& files,
                               const std::vector<Process>& processes) {
  const std::string folder = "/sys/class/net/" + interface;
  const std::string device = files.linkedName(folder + "/device");
  if (device.empty()) return {};  // virtual: no interrupt
  const std::string driver = files.linkedName(folder + "/device/driver");
  const std::string pump = spiController(device);
  // "fe204000.spi": with PREEMPT_RT the controller's own interrupt is a thread too.
  const std::string controller =
      pump.empty() ? std::string{} : files.linkedName("/sys/class/spi_master/" + pump + "/device");
  std::vector<Process> threads;
  for (const auto& process : processes) {
    if (!process.kernel) continue;  // anybody may call a process "irq/57-can0"
    const bool ours = serves(process, device) || serves(process, interface) || serves(process, driver) ||
                      serves(process, controller);
    if (ours || (!pump.empty() && process.name == pump)) threads.push_back(process);
  }
  return threads;
}

std::string priorityText(const Process& thread) {
  return thread.fifo ? std::to_string(thread.priority) : "not real-time";
}

std::vector<PriorityChange> priorityChanges(const std::vector<std::string>& interfaces, int priority,
                                            const HostFiles& files, const std::vector<Process>& processes) {
  std::vector<PriorityChange> changes;
  for (const auto& interface : interfaces) {
    for (const auto& thread : threadsOf(interface, files, processes)) {
      const bool named = std::any_of(changes.begin(), changes.end(), [&thread](const auto& change) {
        return change.thread.pid == thread.pid;
      });
      if (named || (thread.fifo && thread.priority == priority)) continue;
      changes.push_back({interface, thread});
    }
  }
  return changes;
}

std::string missingThreads(const std::string& interface, const HostFiles& files,
                           const std::vector<Process>& processes) {
  if (isDown(interface, files)) return "is down: its interrupt thread is made when it comes up";
  if (threadsOf(interface, files, processes).empty()) return "has none: no thread serves its interrupts";
  return {};
}

}  // namespace rc10::doctor
