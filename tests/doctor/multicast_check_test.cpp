#include "doctor/multicast_check.hpp"

#include <gmock/gmock.h>

#include "host_root.hpp"

namespace rc10::doctor::multicast_check_test {
namespace {

using ::testing::HasSubstr;

constexpr Ipv4 kGroup{239, 255, 76, 67};
constexpr Ipv4 kLocal{127, 0, 0, 1};
constexpr Ipv4 kEthernet{192, 168, 1, 5};
constexpr const char* kTitles =
    "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n";
constexpr const char* kDefault = "wlan0\t00000000\t0101A8C0\t0003\t0\t0\t0\t00000000\t0\t0\t0\n";
constexpr const char* kLoopback = "lo\t434CFFEF\t00000000\t0005\t0\t0\t0\tFFFFFFFF\t0\t0\t0\n";

std::string routeWith(const std::string& lines) {
  const HostRoot root;
  root.write("/proc/net/route", kTitles + lines);
  return routeOf(root.files(), kGroup);
}

TEST(MulticastCheck, TheRouteWithTheLongestMaskDecides) {
  EXPECT_EQ(routeWith(""), "");
  EXPECT_EQ(routeWith(kDefault), "wlan0");
  EXPECT_EQ(routeWith(std::string(kDefault) + kLoopback), "lo");
  EXPECT_EQ(routeWith(std::string(kLoopback) + kDefault), "lo");
  EXPECT_EQ(routeWith("eth0\t000A0A0A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n"), "");
}

TEST(MulticastCheck, WithoutARouteLcmIsDeaf) {
  const auto finding = checkMulticast("", {}, kGroup, 0);
  EXPECT_EQ(finding.verdict, Verdict::kFail);
  EXPECT_THAT(finding.fix, HasSubstr("ip route replace 239.255.76.67/32 dev lo src 127.0.0.1"));
}

TEST(MulticastCheck, OverANetworkThatMayChangeItIsAWarning) {
  EXPECT_EQ(checkMulticast("lo", kLocal, kGroup, 0).verdict, Verdict::kPass);
  EXPECT_EQ(checkMulticast("wlan0", kEthernet, kGroup, 0).verdict, Verdict::kWarn);
  EXPECT_EQ(checkMulticast("wlan0", kEthernet, kGroup, 1).verdict, Verdict::kPass);
}

TEST(MulticastCheck, FromAnotherSourceItIsDroppedByTheService) {
  const auto finding = checkMulticast("lo", kEthernet, kGroup, 0);
  EXPECT_EQ(finding.verdict, Verdict::kWarn);
  EXPECT_THAT(finding.why, HasSubstr("comes from 192.168.1.5"));
  EXPECT_THAT(finding.fix, HasSubstr("src 127.0.0.1"));
  EXPECT_EQ(checkMulticast("lo", {}, kGroup, 0).verdict, Verdict::kPass);
}

}  // namespace
}  // namespace rc10::doctor::multicast_check_test
