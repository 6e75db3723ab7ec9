#include "gateway/own_addresses.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "private_network.hpp"

namespace rc10::gateway::test::own_addresses_test {
namespace {

using namespace std::chrono_literals;

in_addr address(const char* text) {
  in_addr out{};
  EXPECT_EQ(::inet_pton(AF_INET, text, &out), 1);
  return out;
}

TEST(OwnAddressesTest, TheKernelSaysWhichAreOurs) {
  rc10::test::inPrivateNetwork([] {
    ASSERT_EQ(
        std::system("ip link add near0 type veth peer name near1 && ip addr add 192.0.2.1/24 dev near0 && "
                    "ip link set near0 up && ip link set near1 up"),
        0);
    EXPECT_TRUE(isOwnAddress(address("127.0.0.1")));
    EXPECT_TRUE(isOwnAddress(address("192.0.2.1")));
    EXPECT_FALSE(isOwnAddress(address("192.0.2.2")));
    EXPECT_FALSE(isOwnAddress(address("198.51.100.1"))) << "there is no route";
  });
}

TEST(OwnAddressesTest, AnAddressIsAskedForOnceASecond) {
  int asked = 0;
  bool own = true;
  OwnAddresses addresses{[&](in_addr) {
    ++asked;
    return own;
  }};
  const MonotonicTime start{1h};
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(addresses.isOwn(address("192.0.2.1"), start + i * 1ms));
  EXPECT_EQ(asked, 1);
  own = false;  // it went to another computer
  EXPECT_FALSE(addresses.isOwn(address("192.0.2.1"), start + 1s));
  EXPECT_FALSE(addresses.isOwn(address("192.0.2.2"), start + 1s));
  EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace rc10::gateway::test::own_addresses_test
