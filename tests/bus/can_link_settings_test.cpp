#include "bus/can_link_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/netlink.h>

namespace rc10::test::can_link_settings_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr CanLinkSettings kClassic{.bitrate = 500'000};
constexpr CanLinkSettings kFd{.bitrate = 1'000'000, .data_bitrate = 5'000'000};

CanLink controller() {
  CanLink link;
  link.kind = "can";
  return link;
}

CanLink asWanted() {
  auto link = controller();
  link.bitrate = 1'000'000;
  link.data_bitrate = 5'000'000;
  link.fd_on = true;
  link.sample_point = 0.75;
  link.data_sample_point = 0.75;
  return link;
}

TEST(CanLinkSettings, CommandsAreThoseOfIpLink) {
  EXPECT_EQ(upCommand("can0", controller(), kClassic),
            "ip link set can0 up type can bitrate 500000 restart-ms 0");
  EXPECT_EQ(restartCommand("can0", controller(), kClassic, "sudo "),
            "sudo ip link set can0 down; sudo ip link set can0 up type can bitrate 500000 restart-ms 0");
  EXPECT_EQ(upCommand("can0", controller(), kFd),
            "ip link set can0 up type can bitrate 1000000 dbitrate 5000000 fd on restart-ms 0");
  auto points = kFd;
  points.sample_point = 0.666;
  points.data_sample_point = 0.75;
  EXPECT_EQ(upCommand("can0", controller(), points),
            "ip link set can0 up type can bitrate 1000000 sample-point 0.666 dbitrate 5000000 dsample-point "
            "0.750 fd on restart-ms 0");
}

TEST(CanLinkSettings, CommandsTakeAwayWhatIsOnAndHinders) {
  auto link = asWanted();
  link.modes = CAN_CTRLMODE_LISTENONLY | CAN_CTRLMODE_ONE_SHOT | CAN_CTRLMODE_BERR_REPORTING;
  EXPECT_EQ(upCommand("can0", link, kClassic),
            "ip link set can0 up type can bitrate 500000 fd off listen-only off one-shot off restart-ms 0");
}

TEST(CanLinkSettings, OnlyModesThatHinderAreTakenAway) {
  CanLink link;
  link.modes = CAN_CTRLMODE_FD | CAN_CTRLMODE_BERR_REPORTING | CAN_CTRLMODE_3_SAMPLES;
  EXPECT_EQ(hinderingMode(link), nullptr);
  EXPECT_EQ(hinderingModes(link), 0U);
  link.modes |= CAN_CTRLMODE_ONE_SHOT | CAN_CTRLMODE_PRESUME_ACK;
  ASSERT_NE(hinderingMode(link), nullptr);
  EXPECT_EQ(hinderingMode(link)->name, "one-shot");
  EXPECT_EQ(hinderingModes(link), static_cast<unsigned>(CAN_CTRLMODE_ONE_SHOT | CAN_CTRLMODE_PRESUME_ACK));
}

TEST(CanLinkSettings, AVirtualInterfaceTakesFdByItsMtu) {
  EXPECT_EQ(upCommand("vcan0", {}, kClassic), "ip link set vcan0 up");
  EXPECT_EQ(restartCommand("vcan0", {}, kFd), "ip link set vcan0 down; ip link set vcan0 mtu 72 up");
}

TEST(CanLinkSettings, WhatIsAsWantedIsNotTold) {
  EXPECT_THAT(wrongSetting("can0", asWanted(), kFd), IsEmpty());
}

TEST(CanLinkSettings, ADriversRoundingIsNoDifference) {
  auto link = asWanted();
  link.bitrate = 999'999;
  link.data_bitrate = 4'960'000;
  auto wanted = kFd;
  wanted.data_sample_point = 0.8;
  EXPECT_THAT(wrongSetting("can0", link, wanted), IsEmpty());
}

TEST(CanLinkSettings, EachDifferenceIsTold) {
  const auto told = [](auto change, const CanLinkSettings& wanted = kFd) {
    auto link = asWanted();
    change(link);
    return wrongSetting("can0", link, wanted);
  };
  EXPECT_EQ(told([](CanLink& link) { link.bitrate = 500'000; }),
            "can0 is set to 500000 bit/s, the configuration says 1000000");
  EXPECT_EQ(told([](CanLink& link) { link.fd_on = false; }),
            "can0 has CAN FD off, the configuration has data_bitrate");
  EXPECT_EQ(told([](CanLink& link) { link.data_bitrate = 2'000'000; }),
            "can0 is set to 2000000 bit/s in the data phase, the configuration says 5000000");
  EXPECT_EQ(told([](CanLink& link) { link.data_bitrate.reset(); }),
            "can0 is set to 0 bit/s in the data phase, the configuration says 5000000");
  EXPECT_THAT(told([](CanLink&) {}, {.bitrate = 1'000'000}),
              HasSubstr("CAN FD on, the configuration has a classic"));
  auto early = kFd;
  early.data_sample_point = 0.6;
  EXPECT_EQ(told([](CanLink&) {}, early),
            "can0 is set to sample point 0.750 in the data phase, the configuration says 0.600");
  EXPECT_EQ(told([](CanLink& link) { link.modes = CAN_CTRLMODE_LISTENONLY; }),
            "can0 has the mode listen-only on: nothing can be sent");
  EXPECT_THAT(told([](CanLink& link) { link.modes = CAN_CTRLMODE_LOOPBACK; }), HasSubstr("loopback"));
  EXPECT_THAT(told([](CanLink& link) { link.modes = CAN_CTRLMODE_ONE_SHOT; }), HasSubstr("one-shot"));
  EXPECT_THAT(told([](CanLink& link) { link.modes = CAN_CTRLMODE_PRESUME_ACK; }), HasSubstr("presume-ack"));
  EXPECT_THAT(told([](CanLink& link) { link.modes = CAN_CTRLMODE_FD_NON_ISO; }), HasSubstr("fd-non-iso"));
  EXPECT_THAT(told([](CanLink& link) { link.restart_ms = 100; }), HasSubstr("100 ms after bus-off"));
}

TEST(CanLinkSettings, WhatIsNoControllerHasNone) {
  auto link = asWanted();
  link.kind = "vcan";
  EXPECT_THAT(wrongSetting("vcan0", link, kClassic), IsEmpty());
}

}  // namespace
}  // namespace rc10::test::can_link_settings_test
