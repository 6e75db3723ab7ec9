#include "robot_client/session/newest_state.hpp"

#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace newest_state_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime kStart{1000s};

std::shared_ptr<RobotState> stateOf(std::int64_t mono_us) {
  auto state = std::make_shared<RobotState>();
  state->mono_us = mono_us;
  return state;
}

TEST(NewestState, IsLiveForASecond) {
  NewestState newest;
  EXPECT_FALSE(newest.live(kStart));
  EXPECT_TRUE(newest.take(stateOf(5'000'000), kStart));
  EXPECT_TRUE(newest.live(kStart + 1s));
  EXPECT_FALSE(newest.live(kStart + 1001ms));
}

TEST(NewestState, OneThatWaitedInTheQueueOfAPausedProgramIsNotLive) {
  NewestState newest;
  EXPECT_TRUE(newest.take(stateOf(5'000'000), kStart));
  EXPECT_TRUE(newest.take(stateOf(5'020'000), kStart + 10s));
  EXPECT_FALSE(newest.live(kStart + 10s));
  EXPECT_TRUE(newest.take(stateOf(15'020'000), kStart + 10s + 20ms));
  EXPECT_TRUE(newest.live(kStart + 10s + 20ms));
}

}  // namespace
}  // namespace newest_state_test
}  // namespace robot_client
}  // namespace rc10
