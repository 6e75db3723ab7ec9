#include "doctor/kernel_check.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <string>

#include "host_root.hpp"

namespace rc10::doctor::kernel_check_test {
namespace {

using ::testing::HasSubstr;

HostRoot& withVersion(HostRoot& root, const std::string& version) {
  root.write("/proc/sys/kernel/osrelease", "6.12.30");
  root.write("/proc/sys/kernel/arch", "aarch64");
  root.write("/proc/sys/kernel/version", version);
  return root;
}

TEST(KernelCheck, TheVersionOrAFileOfTheKernelTellsThatItIsRealTime) {
  HostRoot mainline;
  withVersion(mainline, "#1 SMP PREEMPT_RT Debian 6.12.30-1");
  EXPECT_EQ(checkPreemption(readKernel(mainline.files())).verdict, Verdict::kPass);
  HostRoot patched;
  withVersion(patched, "#1 SMP");
  patched.write("/sys/kernel/realtime", "1");
  EXPECT_EQ(checkPreemption(readKernel(patched.files())).verdict, Verdict::kPass);
}

TEST(KernelCheck, AnotherKernelIsAWarningThatNamesThePackageOfThisMachine) {
  HostRoot root;
  withVersion(root, "#1 SMP PREEMPT_DYNAMIC");
  const auto finding = checkPreemption(readKernel(root.files()));
  EXPECT_EQ(finding.verdict, Verdict::kWarn);
  EXPECT_THAT(finding.fix, HasSubstr("linux-image-rt-arm64"));
}

TEST(KernelCheck, ThrottlingIsJudgedByWhatItLeaves) {
  const auto verdict = [](std::optional<long long> runtime_us, std::optional<bool> groups) {
    KernelFacts kernel;
    kernel.rt_runtime_us = runtime_us;
    kernel.rt_period_us = 1'000'000;
    kernel.group_scheduling = groups;
    return checkThrottling(kernel).verdict;
  };
  EXPECT_EQ(verdict(std::nullopt, {}), Verdict::kPass);
  EXPECT_EQ(verdict(-1, true), Verdict::kPass);
  EXPECT_EQ(verdict(950'000, false), Verdict::kPass);
  EXPECT_EQ(verdict(950'000, {}), Verdict::kPass);
  EXPECT_EQ(verdict(100'000, {}), Verdict::kWarn);
  EXPECT_EQ(verdict(950'000, true), Verdict::kWarn);
  EXPECT_EQ(verdict(0, {}), Verdict::kFail);
}

TEST(KernelCheck, ReadsThrottlingAndTheKernelsOwnConfiguration) {
  HostRoot root;
  withVersion(root, "#1 SMP");
  root.write("/proc/sys/kernel/sched_rt_runtime_us", "950000");
  root.write("/proc/sys/kernel/sched_rt_period_us", "1000000");
  root.write("/boot/config-6.12.30", "CONFIG_SMP=y\nCONFIG_RT_GROUP_SCHED=y\n");
  const auto kernel = readKernel(root.files());
  EXPECT_EQ(kernel.rt_runtime_us, 950'000);
  EXPECT_EQ(kernel.group_scheduling, true);
}

TEST(KernelCheck, AComputerWithoutTheseFilesIsJudgedAllTheSame) {
  const HostRoot root;
  EXPECT_EQ(checkPreemption(readKernel(root.files())).verdict, Verdict::kWarn);
  EXPECT_EQ(checkThrottling(readKernel(root.files())).verdict, Verdict::kPass);
}

TEST(KernelCheck, TheInstalledSettingsLeaveLockedMemoryWhereItIs) {
  std::ifstream installed(RC10_SOURCE_DIR "/systemd/sysctl.d/60-rc10d.conf");
  std::map<std::string, std::string> settings;
  for (std::string key, equals, value; installed >> key;) {
    if (key.starts_with('#'))
      std::getline(installed, value);
    else if (installed >> equals >> value)
      settings[key] = value;
  }
  HostRoot root;
  root.write("/proc/sys/vm/compact_unevictable_allowed", settings["vm.compact_unevictable_allowed"]);
  const auto kernel = readKernel(root.files());
  EXPECT_EQ(kernel.compact_unevictable, 0);
  EXPECT_EQ(checkCompaction(kernel).verdict, Verdict::kPass);
}

TEST(KernelCheck, LockedMemoryThatTheKernelMayMoveIsAWarning) {
  HostRoot root;
  root.write("/proc/sys/vm/compact_unevictable_allowed", "1");
  const auto finding = checkCompaction(readKernel(root.files()));
  EXPECT_EQ(finding.verdict, Verdict::kWarn);
  EXPECT_THAT(finding.fix, HasSubstr("vm.compact_unevictable_allowed=0"));
  root.write("/proc/sys/vm/compact_unevictable_allowed", "0");
  EXPECT_EQ(checkCompaction(readKernel(root.files())).verdict, Verdict::kPass);
  EXPECT_EQ(checkCompaction(KernelFacts{}).verdict, Verdict::kPass) << "a kernel without compaction";
}

}  // namespace
}  // namespace rc10::doctor::kernel_check_test
