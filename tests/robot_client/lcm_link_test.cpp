#include "rc10/lcm_link.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <future>
#include <memory>
#include <optional>
#include <vector>

namespace rc10 {
inline namespace robot_client {
namespace test::link_test {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 20s;
const std::vector<std::byte> kMessage(4);

TEST(LcmLink, SubscriptionsThatEndMeanwhileTakeNoMessageFromTheOthers) {
  constexpr int kMessages = 2000;
  const LcmLink link("memq://");
  std::atomic<int> first = 0;
  std::atomic<int> last = 0;
  std::promise<void> all;
  const auto at_first = link.subscribe("a", [&](auto) { ++first; });
  std::optional<Subscription> short_lived = link.subscribe("a", [](auto) {});
  const auto at_last = link.subscribe("a", [&](auto) {
    if (++last == kMessages) all.set_value();
  });
  for (int i = 0; i < kMessages; ++i) {
    ASSERT_TRUE(link.publish("a", kMessage));
    // While the link's thread gives out messages. The place of the new one is behind the others.
    short_lived.emplace(link.subscribe("a", [](auto) {}));
  }
  ASSERT_EQ(all.get_future().wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(first, kMessages);
  EXPECT_EQ(last, kMessages);
}

TEST(LcmLink, WhatAnEndedHandlerHeldIsLetGo) {
  const LcmLink link("memq://");
  struct Held {
    std::promise<void>& gone;
    ~Held() { gone.set_value(); }
  };
  std::promise<void> gone;
  auto subscription = link.subscribe("a", [held = std::make_shared<Held>(gone)](auto) {});
  subscription.end();
  EXPECT_EQ(gone.get_future().wait_for(kPatience), std::future_status::ready);
}

TEST(LcmLink, AHandlerMayEndItself) {
  const LcmLink link("memq://");
  int calls = 0;
  Subscription itself;
  std::promise<void> second;
  itself = link.subscribe("a", [&](auto) {
    ++calls;
    itself.end();
  });
  const auto other = link.subscribe("b", [&](auto) { second.set_value(); });
  ASSERT_TRUE(link.publish("a", kMessage));
  ASSERT_TRUE(link.publish("a", kMessage));
  ASSERT_TRUE(link.publish("b", kMessage));
  ASSERT_EQ(second.get_future().wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace test::link_test
}  // namespace robot_client
}  // namespace rc10
