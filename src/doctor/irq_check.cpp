#include "doctor/irq_check.hpp"

#include <algorithm>

namespace rc10::doctor {
namespace {

bool isNumber(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// "irq/57-spi0.0" or, of a name that was too long, "irq/161-mcp2515"(cut).
bool serves(const Process& process, const std::string& name) {
  const auto dash = process.name.find('-');
  if (name.empty() || dash == std::string::npos || process.name.rfind("irq/", 0) != 0) return false;
  const std::string device = process.name.substr(dash + 1);
  return device == name || (process.name.size() == 15 && name.rfind(device, 0) == 0) ||
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

}  // namespace

std::vector<Process> threadsOf(const std::string& interface, const HostFiles& files,
                               const std::vector<Process>& processes) {
  const std::string folder = "/sys/class/net/" + interface;
  const std::string device = files.linkedName(folder + "/device");
  if (device.empty()) return {};  // virtual: no interrupt
  const std::string driver = files.linkedName(folder + "/device/driver");
  const std::string pump = spiController(device);
  std::vector<Process> threads;
  for (const auto& process : processes) {
    const bool ours = serves(process, device) || serves(process, interface) || serves(process, driver);
    if (ours || (!pump.empty() && process.name == pump)) threads.push_back(process);
  }
  return threads;
}

Finding checkInterruptThreads(const std::string& interface, const std::vector<Process>& threads,
                              int rx_priority) {
  const std::string what = interface + " interrupt threads";
  if (threads.empty()) return pass(what, "none: its interrupts are not served by a thread");
  std::string low;
  std::string all;
  std::string fix;
  for (const auto& thread : threads) {
    const std::string words =
        thread.name + " " + (thread.fifo ? std::to_string(thread.priority) : std::string("not real-time"));
    all += (all.empty() ? "" : ", ") + words;
    if (thread.fifo && thread.priority > rx_priority) continue;
    low += (low.empty() ? "" : ", ") + words;
    fix += (fix.empty() ? "" : "; ") + std::string("sudo chrt -f -p 70 ") + std::to_string(thread.pid);
  }
  if (low.empty()) return pass(what, all);
  return warn(what,
              low + ": below rc10d's receive thread (" + std::to_string(rx_priority) +
                  "), which then waits for what it holds up",
              fix + "   # again after each `ip link set " + interface + " up`, which makes new threads");
}

}  // namespace rc10::doctor
