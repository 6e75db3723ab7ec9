#include "doctor/limits_check.hpp"

#include <gmock/gmock.h>

#include "host_root.hpp"

namespace rc10::doctor::limits_check_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kLimits =
    "Limit                     Soft Limit           Hard Limit           Units     \n"
    "Max locked memory         8388608              8388608              bytes     \n"
    "Max realtime priority     0                    0                    \n";

TEST(LimitsCheck, ReadsWhatTheKernelWrites) {
  HostRoot root;
  root.write("/proc/self/limits", kLimits);
  root.write("/proc/self/status", "Name:\tbash\nCapEff:\t0000000000000000");
  const auto limits = readLimits(root.files(), "self");
  EXPECT_EQ(limits.locked_bytes, 8'388'608);
  EXPECT_EQ(limits.realtime_priority, 0);
  EXPECT_FALSE(limits.may_anyway);
}

TEST(LimitsCheck, CapabilitiesMakeLimitsMeaningless) {
  HostRoot root;
  root.write("/proc/7/limits", kLimits);
  root.write("/proc/7/status", "Name:\trc10d\nCapEff:\t000001ffffffffff");
  const auto limits = readLimits(root.files(), "7");
  EXPECT_EQ(checkRealtimeLimit(limits, "rc10d", false, {.rc10d = 65}).verdict, Verdict::kPass);
  EXPECT_EQ(checkMemoryLimit(limits, "rc10d", false).verdict, Verdict::kPass);
}

TEST(LimitsCheck, TooLittleFailsAndNamesTheLineThatMendsIt) {
  const LimitFacts limits{.realtime_priority = 0, .locked_bytes = 8 << 20};
  const auto priority = checkRealtimeLimit(limits, "this shell", false, {.rc10d = 65});
  EXPECT_EQ(priority.verdict, Verdict::kFail);
  EXPECT_THAT(priority.fix, HasSubstr("\"$(id -un) - rtprio 90\""));
  const auto memory = checkMemoryLimit(limits, "this shell", false);
  EXPECT_EQ(memory.verdict, Verdict::kFail);
  EXPECT_THAT(memory.fix, HasSubstr("\"$(id -un) - memlock unlimited\""));
}

TEST(LimitsCheck, TheLineIsForTheUserWhoRunsTheDaemon) {
  HostRoot root;
  root.write("/proc/7/limits", kLimits);
  const auto limits = readLimits(root.files(), "7");
  EXPECT_THAT(checkRealtimeLimit(limits, "rc10d (pid 7)", false, {.rc10d = 65}).fix,
              HasSubstr("\"$(stat -c %U /proc/7) - rtprio 90\""));
}

TEST(LimitsCheck, OfAShellTheyAreAWarningWhereThereIsAService) {
  const LimitFacts limits{.realtime_priority = 64, .locked_bytes = 8 << 20};
  EXPECT_EQ(checkRealtimeLimit(limits, "this shell", true, {.rc10d = 65}).verdict, Verdict::kWarn);
  EXPECT_EQ(checkMemoryLimit(limits, "this shell", true).verdict, Verdict::kWarn);
}

TEST(LimitsCheck, TheGroupThatMayIsNamed) {
  const LimitFacts member_of_rc10{.realtime_priority = 49, .locked_bytes = LimitFacts::kUnlimited};
  const auto finding = checkRealtimeLimit(member_of_rc10, "this shell", false, {.rc10d = 65});
  EXPECT_EQ(finding.verdict, Verdict::kFail);
  EXPECT_THAT(finding.why, HasSubstr("rc10-dev"));
}

TEST(LimitsCheck, EnoughPasses) {
  const LimitFacts limits{.realtime_priority = 65, .locked_bytes = LimitFacts::kUnlimited};
  EXPECT_EQ(checkRealtimeLimit(limits, "this shell", false, {.rc10d = 65}).verdict, Verdict::kPass);
  EXPECT_EQ(checkMemoryLimit(limits, "this shell", false).verdict, Verdict::kPass);
}

TEST(LimitsCheck, WhereAGuardRunsItsPriorityCounts) {
  const auto findingWith = [](long long limit, bool guard) {
    const LimitFacts limits{.realtime_priority = limit, .locked_bytes = LimitFacts::kUnlimited};
    return checkRealtimeLimit(limits, "this shell", false, {.rc10d = 65, .guard = guard});
  };
  for (const long long limit : {65, 66, 79}) {
    const auto finding = findingWith(limit, true);
    EXPECT_EQ(finding.verdict, Verdict::kFail) << limit;
    EXPECT_THAT(finding.why, HasSubstr("rc10-guard asks for 80"));
    EXPECT_EQ(findingWith(limit, false).verdict, Verdict::kPass) << limit;
  }
  EXPECT_EQ(findingWith(80, true).verdict, Verdict::kPass);
  EXPECT_THAT(findingWith(64, false).why, HasSubstr("rc10d asks for 65"));
}

TEST(LimitsCheck, TheServiceIsFoundWhereSystemdLooks) {
  HostRoot root;
  EXPECT_FALSE(serviceInstalled(root.files()));
  root.write("/lib/systemd/system/rc10d.service", "[Unit]");
  EXPECT_TRUE(serviceInstalled(root.files()));
}

}  // namespace
}  // namespace rc10::doctor::limits_check_test
