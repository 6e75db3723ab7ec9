#include "app/receive_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace rc10::test::receive_clock_test {
namespace {

using namespace std::chrono_literals;

// 2026-01-01 on the wall, 1000 s after boot.
constexpr Duration kOffset = 1'767'225'600s - 1000s;

MonotonicTime at(Duration since_boot) { return MonotonicTime{since_boot}; }

WakeUp steadyWake() {
  return {
      .now = at(1000s + 1ms), .previous = at(1000s), .realtime_offset = kOffset, .previous_offset = kOffset};
}

TEST(ReceiveClock, SubtractsTheOffsetBetweenTheClocks) {
  EXPECT_EQ(toMonotonic(kOffset + 1000s + 400us, steadyWake()), at(1000s + 400us));
}

TEST(ReceiveClock, KeepsNanoseconds) {
  EXPECT_EQ(toMonotonic(kOffset + 1000s + 1ns, steadyWake()), at(1000s + 1ns));
}

TEST(ReceiveClock, DoesNotPlaceAFrameInTheFuture) {
  EXPECT_EQ(toMonotonic(kOffset + 1000s + 1200us, steadyWake()), steadyWake().now);
}

TEST(ReceiveClock, DoesNotPlaceAFrameBeforeThePreviousWakeUp) {
  EXPECT_EQ(toMonotonic(kOffset + 999s, steadyWake()), steadyWake().previous);
}

TEST(ReceiveClock, GivesTheOldestPossibleTimeWhenTheWallClockWasSteppedForward) {
  WakeUp wake = steadyWake();
  wake.realtime_offset += 3600s;
  // Stamped after the step, then before it: which one it was cannot be told.
  EXPECT_EQ(toMonotonic(wake.realtime_offset + 1000s + 400us, wake), wake.previous);
  EXPECT_EQ(toMonotonic(wake.previous_offset + 1000s + 400us, wake), wake.previous);
}

TEST(ReceiveClock, GivesTheOldestPossibleTimeWhenTheWallClockWasSteppedBack) {
  WakeUp wake = steadyWake();
  wake.realtime_offset -= 10ms;
  EXPECT_EQ(toMonotonic(wake.realtime_offset + 1000s + 400us, wake), wake.previous);
  EXPECT_EQ(toMonotonic(wake.previous_offset + 1000s + 400us, wake), wake.previous);
}

TEST(ReceiveClock, IsExactAgainAtTheWakeUpAfterAStep) {
  WakeUp wake = steadyWake();
  wake.realtime_offset += 3600s;
  wake.previous_offset = wake.realtime_offset;
  EXPECT_EQ(toMonotonic(wake.realtime_offset + 1000s + 400us, wake), at(1000s + 400us));
}

TEST(ReceiveClock, ForgivesTheNoiseOfReadingTwoClocks) {
  WakeUp wake = steadyWake();
  wake.previous_offset += 50us;
  EXPECT_EQ(toMonotonic(kOffset + 1000s + 400us, wake), at(1000s + 400us));
  wake.previous_offset -= 100us;
  EXPECT_EQ(toMonotonic(kOffset + 1000s + 400us, wake), at(1000s + 400us));
}

TEST(ReceiveClock, MapsEverythingToNowAtTheFirstWakeUp) {
  WakeUp wake = steadyWake();
  wake.previous = wake.now;
  EXPECT_EQ(toMonotonic(kOffset + 5s, wake), wake.now);
  EXPECT_EQ(toMonotonic(kOffset + 5000s, wake), wake.now);
}

}  // namespace
}  // namespace rc10::test::receive_clock_test
