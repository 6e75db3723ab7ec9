#include "doctor/daemon_check.hpp"

#include <gmock/gmock.h>

#include "host_root.hpp"

namespace rc10::doctor::daemon_check_test {
namespace {

using ::testing::HasSubstr;

DaemonFacts service() {
  return {.pid = 7, .root = false, .no_new_privileges = true, .seccomp = true, .unit = "rc10d.service"};
}

TEST(DaemonCheck, ReadsWhatAServiceLooksLike) {
  HostRoot root;
  root.write("/proc/7/status", "Name:\trc10d\nUid:\t990\t990\t990\t990\nNoNewPrivs:\t1\nSeccomp:\t2\n");
  root.write("/proc/7/cgroup", "0::/system.slice/rc10d.service");
  const auto daemons =
      readDaemons(root.files(), {{.pid = 7, .name = "rc10d"}, {.pid = 8, .name = "rc10-lcm"}});
  ASSERT_EQ(daemons.size(), 1U);
  EXPECT_EQ(checkSandbox(daemons, true).verdict, Verdict::kPass);
}

TEST(DaemonCheck, OutsideTheServiceThereIsNoSandbox) {
  auto by_hand = service();
  by_hand.unit.clear();
  EXPECT_EQ(checkSandbox({by_hand}, true).verdict, Verdict::kWarn);
  auto as_root = service();
  as_root.root = true;
  EXPECT_THAT(checkSandbox({as_root}, true).why, HasSubstr("root"));
  auto open = service();
  open.seccomp = false;
  EXPECT_THAT(checkSandbox({open}, true).fix, HasSubstr("systemctl cat rc10d.service"));
  EXPECT_EQ(checkSandbox({}, false).verdict, Verdict::kWarn);
  EXPECT_EQ(checkSandbox({}, true).verdict, Verdict::kPass);
}

TEST(DaemonCheck, AnotherRobotOnOurInterfaceFails) {
  const auto finding = checkOneDaemon({service()}, {{"can0", "robot 'other' (rc10d, pid 7)"}}, "hero");
  EXPECT_EQ(finding.verdict, Verdict::kFail);
  EXPECT_THAT(finding.why, HasSubstr("can0 of robot 'hero' is driven by robot 'other' (rc10d, pid 7)"));
  EXPECT_EQ(checkOneDaemon({service()}, {{"can0", "robot 'hero' (rc10d, pid 7)"}}, "hero").verdict,
            Verdict::kPass);
}

TEST(DaemonCheck, TwoDaemonsAreAWarning) {
  EXPECT_EQ(checkOneDaemon({}, {}, "").verdict, Verdict::kPass);
  EXPECT_EQ(checkOneDaemon({service(), service()}, {}, "").verdict, Verdict::kWarn);
}

}  // namespace
}  // namespace rc10::doctor::daemon_check_test
