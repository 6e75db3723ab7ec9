// The message, taken apart again as the kernel does it. That a controller obeys it is tested in tests/vm.
#include "daemon/interfaces/can_fd_setup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libmnl/libmnl.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <vector>

namespace rc10::test::can_fd_setup_test {
namespace {

using ::testing::ElementsAre;
using ::testing::Key;

using Attributes = std::map<int, std::vector<std::byte>>;

int take(const nlattr* attribute, void* data) {
  const auto* bytes = static_cast<const std::byte*>(mnl_attr_get_payload(attribute));
  (*static_cast<Attributes*>(data))[mnl_attr_get_type(attribute)] = {
      bytes, bytes + mnl_attr_get_payload_len(attribute)};
  return MNL_CB_OK;
}

Attributes inside(const std::vector<std::byte>& nest) {
  Attributes found;
  EXPECT_EQ(mnl_attr_parse_payload(nest.data(), nest.size(), take, &found), MNL_CB_OK);
  return found;
}

template <typename T>
T as(const std::vector<std::byte>& bytes) {
  T value{};
  EXPECT_EQ(bytes.size(), sizeof value);
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

class FdSetupMessage : public ::testing::Test {
 protected:
  Attributes settings(const CanLink& seen, const CanLinkSettings& wanted) {
    const auto message = fdSetupMessage(room, 7, seen, wanted);
    const auto* header = reinterpret_cast<const nlmsghdr*>(message.data());
    EXPECT_TRUE(mnl_nlmsg_ok(header, static_cast<int>(message.size())));
    EXPECT_EQ(header->nlmsg_len, message.size());
    EXPECT_EQ(header->nlmsg_type, RTM_NEWLINK);
    EXPECT_EQ(header->nlmsg_flags, NLM_F_REQUEST | NLM_F_ACK) << "an interface that is gone is not made anew";
    const auto* info = static_cast<const ifinfomsg*>(mnl_nlmsg_get_payload(header));
    EXPECT_EQ(info->ifi_index, 7);
    EXPECT_EQ(info->ifi_change, 0U) << "up and down are not its business";
    Attributes outer;
    EXPECT_EQ(mnl_attr_parse(header, sizeof(ifinfomsg), take, &outer), MNL_CB_OK);
    EXPECT_THAT(outer, ElementsAre(Key(IFLA_LINKINFO)));
    auto link_info = inside(outer[IFLA_LINKINFO]);
    EXPECT_EQ(std::memcmp(link_info[IFLA_INFO_KIND].data(), "can", 3), 0);
    return inside(link_info[IFLA_INFO_DATA]);
  }

  alignas(nlmsghdr) std::array<std::byte, kFdSetupRoom> room{};
};

TEST_F(FdSetupMessage, HasBothBitTimingsFdModeAndNoAutomaticRestart) {
  auto found = settings(
      {}, {.bitrate = 1'000'000, .data_bitrate = 5'000'000, .sample_point = 0.8, .data_sample_point = 0.666});
  EXPECT_THAT(found, ElementsAre(Key(IFLA_CAN_BITTIMING), Key(IFLA_CAN_CTRLMODE), Key(IFLA_CAN_RESTART_MS),
                                 Key(IFLA_CAN_DATA_BITTIMING)));
  const auto nominal = as<can_bittiming>(found[IFLA_CAN_BITTIMING]);
  EXPECT_EQ(nominal.bitrate, 1'000'000U);
  EXPECT_EQ(nominal.sample_point, 800U);
  EXPECT_EQ(nominal.tq, 0U) << "the kernel computes the rest, for this controller's clock";
  const auto data = as<can_bittiming>(found[IFLA_CAN_DATA_BITTIMING]);
  EXPECT_EQ(data.bitrate, 5'000'000U);
  EXPECT_EQ(data.sample_point, 666U);
  const auto mode = as<can_ctrlmode>(found[IFLA_CAN_CTRLMODE]);
  EXPECT_EQ(mode.mask, static_cast<unsigned>(CAN_CTRLMODE_FD));
  EXPECT_EQ(mode.flags, static_cast<unsigned>(CAN_CTRLMODE_FD));
  EXPECT_EQ(as<std::uint32_t>(found[IFLA_CAN_RESTART_MS]), 0U);
}

TEST_F(FdSetupMessage, TakesAwayTheModesThatHinder) {
  CanLink seen;
  seen.modes = CAN_CTRLMODE_LISTENONLY | CAN_CTRLMODE_LOOPBACK | CAN_CTRLMODE_BERR_REPORTING;
  auto found = settings(seen, {.bitrate = 500'000, .data_bitrate = 2'000'000});
  const auto mode = as<can_ctrlmode>(found[IFLA_CAN_CTRLMODE]);
  EXPECT_EQ(mode.mask,
            static_cast<unsigned>(CAN_CTRLMODE_FD | CAN_CTRLMODE_LISTENONLY | CAN_CTRLMODE_LOOPBACK));
  EXPECT_EQ(mode.flags, static_cast<unsigned>(CAN_CTRLMODE_FD));
}

TEST(CanFdSetup, AMissingInterfaceIsTheKernelsAnswer) {
  const auto set = setUpFd("rc10nosuch", {}, {.bitrate = 1'000'000, .data_bitrate = 5'000'000});
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().error, ENODEV);
}

TEST(CanFdSetup, WhatIsNoCanInterfaceIsRefusedByTheKernel) {
  const auto set = setUpFd("lo", {}, {.bitrate = 1'000'000, .data_bitrate = 5'000'000});
  ASSERT_FALSE(set);
  // Without the right to ask, or where there is no CAN at all, it is refused for that.
  EXPECT_THAT(set.error().error, ::testing::AnyOf(EPERM, EOPNOTSUPP));
}

}  // namespace
}  // namespace rc10::test::can_fd_setup_test
