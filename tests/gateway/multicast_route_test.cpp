#include "gateway/multicast_route.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "private_network.hpp"

namespace rc10::gateway::test::multicast_route_test {
namespace {

using rc10::test::addLcmRoute;
using rc10::test::inPrivateNetwork;
using testing::HasSubstr;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

TEST(MulticastRoute, IsAskedOfTheKernel) {
  inPrivateNetwork([] {
    const auto url = *parseUdpmUrl(kUrl);
    const auto none = findRoute(url);
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().message, HasSubstr("`sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1`"));
    ASSERT_TRUE(addLcmRoute());
    const auto route = findRoute(url);
    ASSERT_TRUE(route) << route.error().message;
    EXPECT_EQ(route->interface, "lo");
    EXPECT_TRUE(route->loopback);
    EXPECT_EQ(route->interface_index, 1);
  });
}

TEST(MulticastRoute, HasToBeTheLoopbackWithoutTtl) {
  const MulticastRoute wlan{3, "wlan0", false};
  const MulticastRoute lo{1, "lo", true};
  EXPECT_TRUE(checkRoute(*parseUdpmUrl(kUrl), lo));
  EXPECT_TRUE(checkRoute(*parseUdpmUrl("udpm://?ttl=1"), wlan));
  const auto refused = checkRoute(*parseUdpmUrl(kUrl), wlan);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("leaves by wlan0"));
  EXPECT_THAT(refused.error().message,
              HasSubstr("`sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1`"));
}

}  // namespace
}  // namespace rc10::gateway::test::multicast_route_test
