#include "daemon/exchange/cycle_count.hpp"

#include <gtest/gtest.h>

namespace rc10::test::cycle_count_test {
namespace {

using namespace std::chrono_literals;

TEST(CycleCountTest, RisesWithTime) {
  const auto before = cycleCount();
  const auto until = monotonicNow() + 10us;
  while (monotonicNow() < until) {
  }
  EXPECT_GT(cycleCount(), before);
}

}  // namespace
}  // namespace rc10::test::cycle_count_test
