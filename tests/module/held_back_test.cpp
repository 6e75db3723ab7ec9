#include "module/held_back.hpp"

#include <gtest/gtest.h>

namespace rc10::test::held_back_test {
namespace {

constexpr HeldBack::Command kAsks{.given = true, .safe = false};
constexpr HeldBack::Command kSafe{.given = true, .safe = true};
constexpr HeldBack::Command kNobody{};
constexpr HeldBack::Line kUsable{.usable = true};
constexpr HeldBack::Line kDropped{.usable = true, .dropped = true};
constexpr Tick kTick{.index = 0, .now = {}, .dt_s = 0.001F};
constexpr Tick kLateTick{.index = 0, .now = {}, .dt_s = 0.005F};  // that of a pause of any length

class HeldBackTest : public ::testing::Test {
 protected:
  bool after(int ticks, const HeldBack::Command& command) {
    bool held = true;
    for (int i = 0; i < ticks; ++i) held = held_back_.step(command, kUsable, kTick);
    return held;
  }
  HeldBack held_back_;
};

TEST_F(HeldBackTest, ASafeCommandLetsItGo) {
  EXPECT_TRUE(after(5000, kAsks));
  EXPECT_FALSE(after(1, kSafe));
  EXPECT_FALSE(after(5000, kAsks));
}

TEST_F(HeldBackTest, ASecondWithoutACommandLetsItGo) {
  (void)after(1, kAsks);
  EXPECT_TRUE(after(990, kNobody));
  EXPECT_FALSE(after(10, kNobody));
}

TEST_F(HeldBackTest, APauseIsNoSecondWithoutACommand) {
  (void)after(1, kSafe);
  ASSERT_FALSE(after(100, kAsks));
  EXPECT_TRUE(held_back_.step(kNobody, kDropped, kLateTick));
  EXPECT_TRUE(after(500, kAsks)) << "the same stream goes on";
}

}  // namespace
}  // namespace rc10::test::held_back_test
