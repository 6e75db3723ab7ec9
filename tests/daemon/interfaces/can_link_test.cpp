// Without CAN; tests/vm has controllers.
#include "daemon/interfaces/can_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::test::can_link_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CanLink, AnInterfaceThatIsNoCanControllerHasNoBitRate) {
  const auto link = readCanLink("lo");
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_FALSE(link->isController());
  EXPECT_FALSE(link->bitrate);
  EXPECT_FALSE(link->bus_off);
}

TEST(CanLink, AMissingInterfaceIsNamed) {
  const auto link = readCanLink("rc10nosuch");
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error().message,
              AllOf(HasSubstr("rc10nosuch"), HasSubstr("No such device; `ip link` lists")));
}

TEST(CanLink, WhatIsNoControllerIsNotTakenDown) {
  const auto done = restartCanLink("lo", {.bitrate = 1'000'000});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "'lo' is not a CAN interface");
}

}  // namespace
}  // namespace rc10::test::can_link_test
