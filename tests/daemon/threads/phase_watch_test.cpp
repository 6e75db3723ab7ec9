#include "daemon/threads/phase_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::test::phase_watch_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr Duration kAhead = 1'764'244'800s + 123'456'789ns;

class PhaseWatchTest : public ::testing::Test {
 protected:
  std::vector<std::string> afterStep(Duration step, Duration uncertainty = 100ns) {
    watch.check({kAhead + step, uncertainty}, MonotonicTime{1h});
    std::vector<std::string> texts;
    exchange.notes.consume_all([&](const link::Event& note) {
      EXPECT_EQ(note.code, static_cast<std::int32_t>(EventCode::kPhaseLost));
      EXPECT_EQ(note.severity, Severity::kWarning);
      EXPECT_EQ(note.source.view(), "scheduler");
      texts.emplace_back(note.text.view());
    });
    return texts;
  }

  LinkExchange exchange;
  PhaseWatch watch{TimeGrid::onClock(1ms, 300us, kAhead), kAhead, exchange};
};

TEST_F(PhaseWatchTest, AStepOfTheWallClockIsToldOnce) {
  EXPECT_THAT(afterStep(-3600s + 170us),
              ElementsAre("the wall clock was stepped: ticks lie at 0.47 of its periods, not at 0.30, beside "
                          "those of other computers; restart rc10d to lay them anew"));
  EXPECT_THAT(afterStep(-3600s + 170us), IsEmpty());
  EXPECT_THAT(afterStep(5s + 500us), IsEmpty());
}

TEST_F(PhaseWatchTest, NothingIsToldWhileTheTicksAreWithinATenthOfTheirPlace) {
  EXPECT_THAT(afterStep(0s), IsEmpty());
  EXPECT_THAT(afterStep(100us), IsEmpty());
  EXPECT_THAT(afterStep(-100us), IsEmpty());
  EXPECT_THAT(afterStep(1s), IsEmpty()) << "a leap second";
  EXPECT_THAT(afterStep(-101us), ::testing::SizeIs(1));
}

TEST_F(PhaseWatchTest, AnUncertainMeasurementTellsNothing) {
  EXPECT_THAT(afterStep(500us, 51us), IsEmpty());
  EXPECT_THAT(afterStep(500us, 50us), ::testing::SizeIs(1));
}

TEST(PhaseWatch, KnowsThatAPhaseNearZeroIsNearTheEndOfAPeriod) {
  LinkExchange exchange;
  PhaseWatch watch{TimeGrid::onClock(1ms, 20us, kAhead), kAhead, exchange};
  watch.check({kAhead - 60us, 0ns}, MonotonicTime{1h});
  EXPECT_TRUE(exchange.notes.empty());
}

}  // namespace
}  // namespace rc10::test::phase_watch_test
