#include "client/catch_up.hpp"

#include <gtest/gtest.h>

namespace rc10::client::test::catch_up_test {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kStartUs = 1'000'000'000;

MonotonicTime at(std::int64_t us) { return MonotonicTime{std::chrono::microseconds{us}}; }

TEST(CatchUp, IsDoneWhileTheProgramTurns) {
  CatchUp catch_up;
  for (std::int64_t us = 0; us < 5'000'000; us += 50'000)
    EXPECT_TRUE(catch_up.done(at(kStartUs + us), kStartUs)) << us;
}

TEST(CatchUp, WaitsAfterAPauseForSomethingYounger) {
  CatchUp catch_up;
  EXPECT_TRUE(catch_up.done(at(kStartUs), kStartUs - 5000));
  const auto resumed_us = kStartUs + 300'000;
  EXPECT_FALSE(catch_up.done(at(resumed_us), resumed_us - 5000));
  EXPECT_FALSE(catch_up.done(at(resumed_us + 2000), resumed_us - 1));
  EXPECT_TRUE(catch_up.done(at(resumed_us + 4000), resumed_us));
}

}  // namespace
}  // namespace rc10::client::test::catch_up_test
