#include "doctor/cpu_check.hpp"

#include <gmock/gmock.h>

#include "host_root.hpp"

namespace rc10::doctor::cpu_check_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(CpuCheck, SetsOfCpusAreReadAsTheKernelWritesThem) {
  EXPECT_THAT(cpuList("0-2,5"), ElementsAre(0, 1, 2, 5));
  EXPECT_TRUE(cpuList("").empty());
  EXPECT_TRUE(cpuList("nonsense,0-99999999,-1").empty());
}

TEST(CpuCheck, EveryGovernorHasToBePerformance) {
  HostRoot root;
  root.write("/sys/devices/system/cpu/online", "0-1");
  root.write("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  root.write("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance");
  EXPECT_EQ(checkGovernor(readCpus(root.files())).verdict, Verdict::kPass);
  root.write("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "ondemand");
  const auto finding = checkGovernor(readCpus(root.files()));
  EXPECT_EQ(finding.verdict, Verdict::kWarn);
  EXPECT_THAT(finding.why, HasSubstr("ondemand"));
}

TEST(CpuCheck, CpusOfAFixedFrequencyHaveNoGovernor) {
  HostRoot root;
  root.write("/sys/devices/system/cpu/online", "0-3");
  EXPECT_EQ(checkGovernor(readCpus(root.files())).verdict, Verdict::kPass);
}

TEST(CpuCheck, APinnedCpuHasToExistAndToBeIsolated) {
  const CpuFacts cpus{.online = {0, 1, 2, 3}, .isolated = {3}, .governors = {}};
  EXPECT_EQ(checkIsolation(cpus, {.scheduler = 3, .rx = 3, .rx_reads_can = true}).verdict, Verdict::kPass);
  const auto shared = checkIsolation(cpus, {.scheduler = 2, .rx = 3, .rx_reads_can = true});
  EXPECT_EQ(shared.verdict, Verdict::kWarn);
  EXPECT_THAT(shared.fix, HasSubstr("domain,2 nohz_full=2"));
  EXPECT_EQ(checkIsolation(cpus, {.scheduler = 4, .rx = {}}).verdict, Verdict::kFail);
}

TEST(CpuCheck, AReceiveThreadThatReadsNoCanMayShareItsCpu) {
  const CpuFacts cpus{.online = {0, 1, 2, 3}, .isolated = {3}, .governors = {}};
  EXPECT_EQ(checkIsolation(cpus, {.scheduler = 3, .rx = 2}).verdict, Verdict::kPass);
  EXPECT_EQ(checkIsolation(cpus, {.scheduler = 3, .rx = 2, .rx_reads_can = true}).verdict, Verdict::kWarn);
  EXPECT_EQ(checkIsolation(cpus, {.scheduler = 3, .rx = 4}).verdict, Verdict::kFail) << "there is none";
  EXPECT_THAT(checkIsolation(cpus, {}).fix, HasSubstr("section scheduler"));
}

TEST(CpuCheck, AnIsolatedCpuThatNobodyUsesIsTold) {
  const auto finding = checkIsolation({.online = {0, 1, 2, 3}, .isolated = {3}, .governors = {}}, {});
  EXPECT_EQ(finding.verdict, Verdict::kWarn);
  EXPECT_THAT(finding.fix, HasSubstr("cpu: 3"));
}

TEST(CpuCheck, WithoutIsolationTheLastCpuIsProposed) {
  EXPECT_THAT(checkIsolation({.online = {0, 1, 2, 3}, .isolated = {}, .governors = {}}, {}).fix,
              HasSubstr("rcu_nocbs=3"));
  EXPECT_EQ(checkIsolation({.online = {0, 1}, .isolated = {}, .governors = {}}, {}).verdict, Verdict::kPass);
}

}  // namespace
}  // namespace rc10::doctor::cpu_check_test
