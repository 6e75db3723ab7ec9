#include "bus/can_link_news.hpp"

#include <gmock/gmock.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <cstring>

namespace rc10::can_link_news_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Datagram = std::vector<std::byte>;

template <typename T>
void append(Datagram& bytes, const T& value) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof value);
}

void pad(Datagram& bytes) { bytes.resize(NLMSG_ALIGN(bytes.size())); }

Datagram message(unsigned short type, unsigned short hardware, unsigned flags, const std::string& name) {
  Datagram bytes;
  nlmsghdr header{};
  header.nlmsg_type = type;
  append(bytes, header);
  ifinfomsg info{};
  info.ifi_type = hardware;
  info.ifi_flags = flags;
  append(bytes, info);
  // The name is not the first of the attributes.
  append(bytes, rtattr{.rta_len = RTA_LENGTH(1), .rta_type = IFLA_OPERSTATE});
  append(bytes, std::byte{2});
  pad(bytes);
  append(bytes, rtattr{.rta_len = static_cast<unsigned short>(RTA_LENGTH(name.size() + 1)),
                       .rta_type = IFLA_IFNAME});
  for (const char c : name) append(bytes, c);
  append(bytes, '\0');
  const auto length = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data(), &length, sizeof length);
  pad(bytes);
  return bytes;
}

Datagram operator+(Datagram first, const Datagram& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST(CanLinkNews, ACanInterfaceThatComesUpIsTold) {
  EXPECT_THAT(parseLinkNews(message(RTM_NEWLINK, ARPHRD_CAN, IFF_UP | IFF_RUNNING, "can0")),
              ElementsAre(CanLinkNews{.interface = "can0", .is_can = true, .up = true}));
}

TEST(CanLinkNews, OneThatGoesDownAndOneThatIsNoCanAreToldAsSuch) {
  EXPECT_THAT(parseLinkNews(message(RTM_NEWLINK, ARPHRD_CAN, 0, "can0") +
                            message(RTM_NEWLINK, ARPHRD_ETHER, IFF_UP, "eth0")),
              ElementsAre(CanLinkNews{.interface = "can0", .is_can = true, .up = false},
                          CanLinkNews{.interface = "eth0", .is_can = false, .up = true}));
}

TEST(CanLinkNews, OtherMessagesAreLeftOut) {
  EXPECT_THAT(parseLinkNews(message(RTM_DELLINK, ARPHRD_CAN, IFF_UP, "can0") +
                            message(NLMSG_DONE, ARPHRD_CAN, IFF_UP, "can0")),
              IsEmpty());
}

TEST(CanLinkNews, WhatIsCutOffIsLeftOut) {
  const auto whole = message(RTM_NEWLINK, ARPHRD_CAN, IFF_UP, "can0");
  const auto both = whole + message(RTM_NEWLINK, ARPHRD_CAN, IFF_UP, "can1");
  // Behind can1's name three bytes only fill up.
  for (std::size_t size = 0; size < both.size() - 3; ++size) {
    // As memory of its own, so that AddressSanitizer sees a step too far.
    const Datagram cut(both.begin(), both.begin() + static_cast<std::ptrdiff_t>(size));
    const std::size_t complete = size < whole.size() - 3 ? 0 : 1;
    EXPECT_EQ(parseLinkNews(cut).size(), complete) << size;
  }
}

TEST(CanLinkNews, ALengthThatCannotBeEndsTheDatagram) {
  auto bytes = message(RTM_NEWLINK, ARPHRD_CAN, IFF_UP, "can0");
  for (const std::uint32_t length : {0U, 3U, 15U, 0xFFFFFFFFU}) {
    std::memcpy(bytes.data(), &length, sizeof length);
    EXPECT_THAT(parseLinkNews(bytes), IsEmpty()) << length;
  }
}

}  // namespace
}  // namespace rc10::can_link_news_test
