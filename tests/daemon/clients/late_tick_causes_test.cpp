#include "daemon/clients/late_tick_causes.hpp"

#include <gtest/gtest.h>

namespace rc10::test::late_tick_causes_test {
namespace {

using namespace std::chrono_literals;

class LateTickCausesTest : public ::testing::Test {
 protected:
  LateTickCausesTest() { update(); }
  /// A window in which the thread waited for its CPU as it always does.
  void update(Duration waited_more = 30us) {
    if (waited) *waited += waited_more;
    ticks += window;
    causes.update(late, ticks,
                  {.waited = [this] { return waited; }, .page_faults = [this] { return page_faults; }});
  }
  std::uint64_t others(LateCause cause) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < kLateCauses; ++i) sum += causes.count(static_cast<LateCause>(i));
    return sum - causes.count(cause);
  }

  LateTicks late;
  std::optional<Duration> waited{5ms};
  std::uint64_t ticks = 1000;
  std::uint64_t window = 20;
  std::uint64_t page_faults = 400;  // of the start
  LateTickCauses causes;
};

TEST_F(LateTickCausesTest, AThreadThatWaitedForItsCpuLostItToOthers) {
  late.record(TickStep::kWake, 900us);
  update(880us);
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
  EXPECT_EQ(others(LateCause::kCpuTaken), 0U);
}

TEST_F(LateTickCausesTest, OneThatDidNotWasWokenLate) {
  late.record(TickStep::kWake, 900us);
  update();
  EXPECT_EQ(causes.count(LateCause::kTimer), 1U);
  EXPECT_EQ(others(LateCause::kTimer), 0U);
}

TEST_F(LateTickCausesTest, ALongTickHasTheCauseOfItsLongestStepUnlessTheCpuWasTaken) {
  late.record(TickStep::kReceive, 700us);
  update();
  late.record(TickStep::kModules, 700us);
  update();
  late.record(TickStep::kControl, 700us);
  update();
  late.record(TickStep::kSend, 700us);
  update();
  late.record(TickStep::kPublish, 700us);
  update();
  for (const auto cause :
       {LateCause::kReceive, LateCause::kModules, LateCause::kControl, LateCause::kSend, LateCause::kPublish})
    EXPECT_EQ(causes.count(cause), 1U) << static_cast<int>(cause);
  late.record(TickStep::kSend, 700us);
  update(650us);
  EXPECT_EQ(causes.count(LateCause::kSend), 1U);
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
}

TEST_F(LateTickCausesTest, APageFaultIsTheCauseWhateverElseThereWas) {
  late.record(TickStep::kControl, 5ms);
  ++page_faults;
  update(4ms);
  EXPECT_EQ(causes.count(LateCause::kPageFault), 1U);
  EXPECT_EQ(others(LateCause::kPageFault), 0U);
}

TEST_F(LateTickCausesTest, APageFaultOfASecondAgoIsNoCause) {
  ++page_faults;
  for (int i = 0; i < 50; ++i) update();
  late.record(TickStep::kWake, 900us);
  update();
  EXPECT_EQ(causes.count(LateCause::kTimer), 1U);
  EXPECT_EQ(causes.count(LateCause::kPageFault), 0U);
}

TEST_F(LateTickCausesTest, PageFaultsOfTheStartAreNoCause) {
  late.record(TickStep::kWake, 900us);
  update();
  EXPECT_EQ(causes.count(LateCause::kPageFault), 0U);
}

// The tick is counted when it is over, its wait when it begins.
TEST_F(LateTickCausesTest, AWaitThatWasSeenAWindowBeforeItsTickCounts) {
  update(900us);
  late.record(TickStep::kWake, 900us);
  update();
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
}

TEST_F(LateTickCausesTest, TheWaitOfOneLateTickIsNotCountedForTheNext) {
  late.record(TickStep::kWake, 900us);
  update(900us);
  late.record(TickStep::kWake, 900us);
  update();
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
  EXPECT_EQ(causes.count(LateCause::kTimer), 1U);
}

TEST_F(LateTickCausesTest, TheUsualWaitOfAWindowTakesNothing) {
  for (int i = 0; i < 3; ++i) update(80us);
  late.record(TickStep::kSend, 100us);
  update(85us);
  EXPECT_EQ(causes.count(LateCause::kSend), 1U) << "of 80 ticks at 4 kHz each waits a microsecond";
  late.record(TickStep::kWake, 100us);
  update(170us);
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
}

TEST_F(LateTickCausesTest, AWaitThatBecameTheUsualOneIsFollowed) {
  for (int i = 0; i < 60; ++i) update(400us);
  late.record(TickStep::kSend, 300us);
  update(400us);
  EXPECT_EQ(causes.count(LateCause::kSend), 1U);
}

TEST_F(LateTickCausesTest, WindowsAreAsLongAsTheyAre) {
  for (int i = 0; i < 3; ++i) update(200us);
  window = 300;  // the link thread was late
  late.record(TickStep::kWake, 2ms);
  update(3ms);
  EXPECT_EQ(causes.count(LateCause::kTimer), 1U);
  window = 10;
  update(100us);
  window = 20;
  late.record(TickStep::kWake, 400us);
  update(200us);
  EXPECT_EQ(causes.count(LateCause::kTimer), 2U);
}

TEST_F(LateTickCausesTest, AWaitThatComesAndGoesIsUsualToo) {
  for (int i = 0; i < 60; ++i) update(i % 2 == 0 ? 100us : 500us);
  update(500us);
  late.record(TickStep::kWake, 700us);
  update(500us);
  EXPECT_EQ(causes.count(LateCause::kTimer), 1U);
}

TEST_F(LateTickCausesTest, NoWaitTakesTheCpu) {
  waited.reset();
  late.record(TickStep::kSend, 0us);
  update();
  EXPECT_EQ(causes.count(LateCause::kSend), 1U);
}

TEST_F(LateTickCausesTest, AWaitExplainsOneLateTickAndNotItsNeighbour) {
  update();
  late.record(TickStep::kWake, 900us);
  late.record(TickStep::kSend, 300us);
  update(920us);
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
  EXPECT_EQ(causes.count(LateCause::kSend), 1U);
  late.record(TickStep::kReceive, 210us);
  late.record(TickStep::kSend, 700us);
  update(690us);
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 2U) << "the longer one";
  EXPECT_EQ(causes.count(LateCause::kReceive), 1U);
}

TEST_F(LateTickCausesTest, AKernelThatDoesNotTellLeavesTheStep) {
  waited.reset();
  update();
  late.record(TickStep::kWake, 900us);
  update();
  EXPECT_EQ(causes.count(LateCause::kTimer), 1U);
}

TEST_F(LateTickCausesTest, EveryCauseHasACounterAndAdviceOfItsOwn) {
  for (std::size_t i = 0; i < kLateCauses; ++i) {
    EXPECT_EQ(kLateCauseWords[i].counter.substr(0, 12), "late ticks: ");
    EXPECT_LE(kLateCauseWords[i].counter.size(), 48U);
    EXPECT_FALSE(kLateCauseWords[i].advice.empty());
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(kLateCauseWords[i].counter, kLateCauseWords[j].counter);
  }
}

// ---- Wake-ups

TEST(LatenessOfWakeTest, ATickThatOverranIsNoLateTimerOfTheNextOne) {
  const MonotonicTime due{5ms};
  EXPECT_EQ(latenessOfWake(due, due - 400us, due + 300us), 300us);
  EXPECT_EQ(latenessOfWake(due, due + 700us, due + 710us), 10us) << "it had taken so long";
  EXPECT_EQ(latenessOfWake(due, {}, due + 250us), 250us) << "the first";
}

TEST(LateTickTest, AFifthOfAPeriodIsLateAndHalfOfOneIsLong) {
  EXPECT_FALSE(beginsLate(200us, 1ms));
  EXPECT_TRUE(beginsLate(200us + 1ns, 1ms));
  EXPECT_FALSE(beginsLate(200us + 1ns, 2ms));
  EXPECT_FALSE(takesLong(500us, 1ms));
  EXPECT_TRUE(takesLong(500us + 1ns, 1ms));
  EXPECT_FALSE(takesLong(500us + 1ns, 2ms));
}

// ---- Steps

TEST(TickMarksTest, TheLongestStepIsWhereTheTimeWent) {
  const auto marks = [](std::array<unsigned, 5> cycles) {
    TickMarks out;
    out.woken = UINT64_MAX - 5;  // the count begins anew somewhere
    out.received = out.woken + cycles[0];
    out.moved = out.received + cycles[1];
    out.packed = out.moved + cycles[2];
    out.sent = out.packed + cycles[3];
    out.done = out.sent + cycles[4];
    return out.longest();
  };
  EXPECT_EQ(marks({9, 1, 2, 3, 4}), TickStep::kReceive);
  EXPECT_EQ(marks({1, 9, 2, 3, 4}), TickStep::kModules);
  EXPECT_EQ(marks({1, 2, 9, 3, 4}), TickStep::kControl);
  EXPECT_EQ(marks({1, 2, 3, 9, 4}), TickStep::kSend);
  EXPECT_EQ(marks({1, 2, 3, 4, 9}), TickStep::kPublish);
}

}  // namespace
}  // namespace rc10::test::late_tick_causes_test
