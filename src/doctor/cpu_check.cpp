#include "doctor/cpu_check.hpp"

#include <algorithm>
#include <set>

namespace rc10::doctor {
namespace {

constexpr const char* kCpus = "/sys/devices/system/cpu";

std::string listOf(const std::vector<int>& cpus) {
  std::string text;
  for (const int cpu : cpus) text += (text.empty() ? "" : ",") + std::to_string(cpu);
  return text;
}

bool has(const std::vector<int>& cpus, int cpu) {
  return std::find(cpus.begin(), cpus.end(), cpu) != cpus.end();
}

// For the kernel's command line: REALTIME's recipe, with the last CPU unless others are named.
std::string isolate(const std::vector<int>& wanted) {
  const std::string set = listOf(wanted);
  return "add to the kernel's command line (Raspberry Pi: /boot/firmware/cmdline.txt): "
         "isolcpus=managed_irq,domain," +
         set + " nohz_full=" + set + " rcu_nocbs=" + set;
}

}  // namespace

CpuFacts readCpus(const HostFiles& files) {
  CpuFacts facts;
  facts.online = cpuList(files.read(std::string(kCpus) + "/online").value_or(""));
  facts.isolated = cpuList(files.read(std::string(kCpus) + "/isolated").value_or(""));
  std::set<std::string> governors;
  for (const int cpu : facts.online) {
    const auto governor =
        files.read(std::string(kCpus) + "/cpu" + std::to_string(cpu) + "/cpufreq/scaling_governor");
    if (governor) governors.insert(*governor);
  }
  facts.governors.assign(governors.begin(), governors.end());
  return facts;
}

Finding checkGovernor(const CpuFacts& cpus) {
  const std::string what = "CPU governor";
  if (cpus.governors.empty()) return pass(what, "Linux does not change the frequency of these CPUs");
  if (cpus.governors == std::vector<std::string>{"performance"}) return pass(what, "performance");
  std::string words;
  for (const auto& governor : cpus.governors) words += (words.empty() ? "" : ", ") + governor;
  return warn(what, words + ": a CPU that was slowed down wakes up late",
              "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
}

Finding checkIsolation(const CpuFacts& cpus, const PinnedThreads& threads) {
  const std::string what = "CPU isolation";
  for (const auto& cpu : {threads.scheduler, threads.rx}) {
    if (cpu && !has(cpus.online, *cpu)) {
      return fault(what,
                   "the configuration pins rc10d to CPU " + std::to_string(*cpu) + "; there are " +
                       listOf(cpus.online),
                   "change `cpu:` in the configuration");
    }
  }
  std::vector<int> pinned;
  if (threads.scheduler) pinned.push_back(*threads.scheduler);
  if (threads.rx && threads.rx_reads_can && threads.rx != threads.scheduler) pinned.push_back(*threads.rx);
  std::vector<int> shared;
  for (const int cpu : pinned) {
    if (!has(cpus.isolated, cpu)) shared.push_back(cpu);
  }
  if (!shared.empty()) {
    return warn(what, "rc10d is pinned to CPU " + listOf(shared) + ", which others use too", isolate(shared));
  }
  if (!pinned.empty()) return pass(what, "rc10d has CPU " + listOf(pinned) + " for itself");
  if (!cpus.isolated.empty()) {
    return warn(
        what,
        "CPU " + listOf(cpus.isolated) + " is isolated, and rc10d is not pinned to it: it runs elsewhere",
        "set `cpu: " + std::to_string(cpus.isolated.back()) + "` in the configuration's section" +
            (threads.rx_reads_can ? "s scheduler and rx" : " scheduler"));
  }
  if (cpus.online.size() < 3) return pass(what, "none; there are too few CPUs to give one away");
  return warn(what, "rc10d shares its CPU with everything else",
              isolate({cpus.online.back()}) + "; then `cpu: " + std::to_string(cpus.online.back()) +
                  "` in the configuration");
}

}  // namespace rc10::doctor
