// When the link of a bus is restarted, in virtual time.

#include "daemon/interfaces/can_link_recovery.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace rc10::test::can_link_recovery_test {
namespace {

using namespace std::chrono_literals;

class CanLinkRecoveryTest : public ::testing::Test {
 protected:
  /// Asks every 10 ms; the moments, since the start of the test, at which a restart was due.
  std::vector<Duration> run(BusState state, Duration time) {
    std::vector<Duration> out;
    for (const auto end = now + time; now < end; now += 10ms) {
      const auto step = recovery.update(now, state);
      if (!step.due) continue;
      out.push_back(now - start);
      firsts += step.first ? 1 : 0;
    }
    return out;
  }

  const MonotonicTime start{1000s};
  MonotonicTime now = start;
  CanLinkRecovery recovery;
  int firsts = 0;
};

TEST_F(CanLinkRecoveryTest, ABusThatIsWellIsLeftAlone) {
  for (const auto state : {BusState::kActive, BusState::kWarning, BusState::kPassive, BusState::kSilent}) {
    EXPECT_TRUE(run(state, 10s).empty());
  }
}

TEST_F(CanLinkRecoveryTest, AnInterfaceThatIsGoneCannotBeRestarted) {
  EXPECT_TRUE(run(BusState::kGone, 10s).empty());
}

TEST_F(CanLinkRecoveryTest, TheDistanceDoublesFrom50MillisecondsTo2Seconds) {
  EXPECT_EQ(run(BusState::kBusOff, 9s),
            (std::vector<Duration>{50ms, 150ms, 350ms, 750ms, 1550ms, 3150ms, 5150ms, 7150ms}));
  EXPECT_EQ(firsts, 1);
  EXPECT_EQ(recovery.attempts(), 8);
}

TEST_F(CanLinkRecoveryTest, StalledAndDownAreTroubleToo) {
  for (const auto state : {BusState::kStalled, BusState::kDown}) {
    recovery = {};
    EXPECT_EQ(run(state, 100ms).size(), 1U);
  }
}

TEST_F(CanLinkRecoveryTest, TroubleThatEndsByItselfNeedsNoRestart) {
  EXPECT_TRUE(run(BusState::kStalled, 40ms).empty());
  EXPECT_TRUE(run(BusState::kActive, 1s).empty());
  EXPECT_TRUE(run(BusState::kStalled, 40ms).empty());
  EXPECT_EQ(recovery.attempts(), 0);
}

TEST_F(CanLinkRecoveryTest, ABusThatFailsAgainAndAgainIsNotRestartedMoreOften) {
  EXPECT_EQ(run(BusState::kBusOff, 60ms).size(), 1U);  // at 50 ms
  EXPECT_TRUE(run(BusState::kActive, 20ms).empty());
  EXPECT_EQ(run(BusState::kBusOff, 110ms), std::vector<Duration>{180ms});  // 100 ms after it failed again
  EXPECT_TRUE(run(BusState::kActive, 4900ms).empty());
  const auto failed = now - start;
  EXPECT_EQ(run(BusState::kBusOff, 210ms), std::vector<Duration>{failed + 200ms});
  EXPECT_EQ(firsts, 3);
}

TEST_F(CanLinkRecoveryTest, FiveGoodSecondsMakeItQuickAgain) {
  (void)run(BusState::kBusOff, 9s);
  (void)run(BusState::kActive, 5010ms);
  EXPECT_EQ(recovery.attempts(), 0);
  const auto failed = now - start;
  EXPECT_EQ(run(BusState::kBusOff, 60ms), std::vector<Duration>{failed + 50ms});
}

}  // namespace
}  // namespace rc10::test::can_link_recovery_test
