#include "doctor/kernel_check.hpp"

#include <cmath>

#include "app/preempt_rt.hpp"

namespace rc10::doctor {
namespace {

constexpr const char* kThrottling = "real-time throttling";

// With a share of 0 no real-time thread can be created; with less than this rc10d and another one together
// could reach the limit.
constexpr double kLeastShare = 0.5;

std::string debianMachine(const HostFiles& files) {
  const auto type = files.read("/proc/sys/kernel/arch");
  if (!type) return {};
  if (*type == "x86_64") return "amd64";
  return *type == "aarch64" ? "arm64" : "";
}

std::optional<bool> groupScheduling(const HostFiles& files, const std::string& release) {
  const auto config = files.read("/boot/config-" + release);
  if (!config) return std::nullopt;
  return config->find("\nCONFIG_RT_GROUP_SCHED=y") != std::string::npos;
}

std::string percentOf(double share) { return std::to_string(std::lround(share * 100.0)) + " %"; }

}  // namespace

KernelFacts readKernel(const HostFiles& files) {
  KernelFacts kernel;
  kernel.release = files.read("/proc/sys/kernel/osrelease").value_or("");
  kernel.machine = debianMachine(files);
  kernel.preempt_rt = isPreemptRt(files.read("/sys/kernel/realtime").value_or(""),
                                  files.read("/proc/sys/kernel/version").value_or(""));
  kernel.group_scheduling = groupScheduling(files, kernel.release);
  kernel.rt_runtime_us = files.number("/proc/sys/kernel/sched_rt_runtime_us");
  kernel.rt_period_us = files.number("/proc/sys/kernel/sched_rt_period_us");
  kernel.compact_unevictable = files.number("/proc/sys/vm/compact_unevictable_allowed");
  return kernel;
}

Finding checkPreemption(const KernelFacts& kernel) {
  const std::string what = "kernel";
  if (kernel.preempt_rt) return pass(what, kernel.release + ", PREEMPT_RT");
  const std::string package =
      kernel.machine.empty() ? "linux-image-rt-<amd64|arm64>" : "linux-image-rt-" + kernel.machine;
  return warn(
      what,
      kernel.release +
          " is not PREEMPT_RT: a driver may hold a tick up for milliseconds, whatever the "
          "priorities. The latency test says what this one does",
      "sudo apt install " + package +
          "   # Raspberry Pi OS: build bcm2711_rt_defconfig or bcm2712's; Ubuntu: linux-raspi-realtime; "
          "Jetson: NVIDIA's RT kernel package");
}

Finding checkThrottling(const KernelFacts& kernel) {
  if (!kernel.rt_runtime_us) return pass(kThrottling, "this kernel has none");
  const auto runtime = *kernel.rt_runtime_us;
  if (runtime < 0) return pass(kThrottling, "off; LimitRTTIME of the service ends a thread that spins");
  const double share =
      static_cast<double>(runtime) / static_cast<double>(kernel.rt_period_us.value_or(1'000'000));
  const std::string found = "sched_rt_runtime_us is " + std::to_string(runtime) + ": ";
  const std::string fix =
      "sudo sysctl -w kernel.sched_rt_runtime_us=950000   # to keep it: /etc/sysctl.d/90-rc10d.conf";
  if (runtime == 0) return fault(kThrottling, found + "no thread may be real-time", fix);
  if (kernel.group_scheduling == true) {
    return warn(kThrottling,
                "the kernel has CONFIG_RT_GROUP_SCHED: services get no real-time priority, even as root",
                "sudo sysctl -w kernel.sched_rt_runtime_us=-1   # to keep it: /etc/sysctl.d/90-rc10d.conf");
  }
  if (share < kLeastShare)
    return warn(kThrottling, found + "real-time threads get " + percentOf(share) + " of the time", fix);
  return pass(kThrottling, found + "only a thread that spins for " + percentOf(share) +
                               " of a second is held back; rc10d sleeps in every tick");
}

Finding checkCompaction(const KernelFacts& kernel) {
  const std::string what = "memory compaction";
  if (kernel.compact_unevictable.value_or(0) == 0) return pass(what, "leaves locked memory where it is");
  return warn(what,
              "vm.compact_unevictable_allowed is 1: the kernel may move locked memory, and a tick that meets "
              "that waits",
              "sudo sysctl -w vm.compact_unevictable_allowed=0   # to keep it: /etc/sysctl.d/90-rc10d.conf");
}

}  // namespace rc10::doctor
