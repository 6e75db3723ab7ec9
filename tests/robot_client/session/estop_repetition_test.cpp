#include "robot_client/session/estop_repetition.hpp"

#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace estop_repetition_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime kStart{1s};

TEST(EstopRepetition, RepeatsNothingBeforeTheFirst) {
  const EstopRepetition repetition;
  EXPECT_EQ(repetition.number(), std::nullopt);
  EXPECT_EQ(repetition.due(kStart), std::nullopt);
  EXPECT_EQ(repetition.nextDue(), std::nullopt);
}

TEST(EstopRepetition, IsDueEveryTwentyMillisecondsUnderItsNumberUntilTheStateShowsIt) {
  EstopRepetition repetition;
  auto now = kStart;
  repetition.sent(7, now);
  for (int times = 0; times < 3; ++times) {
    EXPECT_EQ(repetition.due(now + 20ms - 1ns), std::nullopt);
    EXPECT_EQ(repetition.nextDue(), now + 20ms);
    now += 20ms;
    EXPECT_EQ(repetition.due(now), 7);
    repetition.sent(7, now);
  }
  repetition.shown(kStart - 1ns);  // of an e-stop before, that has been cleared since
  EXPECT_EQ(repetition.number(), 7);
  repetition.shown(kStart + 1ms);
  EXPECT_EQ(repetition.due(now + 1s), std::nullopt);
  EXPECT_EQ(repetition.nextDue(), std::nullopt);
}

}  // namespace
}  // namespace estop_repetition_test
}  // namespace robot_client
}  // namespace rc10
