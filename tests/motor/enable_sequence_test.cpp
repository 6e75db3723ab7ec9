#include "motor/enable_sequence.hpp"

#include <gtest/gtest.h>

namespace rc10::enable_sequence_test {
namespace {

using std::chrono::milliseconds;

enum class Step : std::uint8_t { kStop, kEnable };

class EnableSequenceTest : public ::testing::Test {
 protected:
  static constexpr Duration kPatience = milliseconds{50};
  static constexpr int kTries = 3;

  EnableSequenceTest() { sequence.begin(Step::kStop); }
  [[nodiscard]] static MonotonicTime at(int ms) { return MonotonicTime{milliseconds{1000 + ms}}; }

  EnableSequence<Step> sequence{kPatience, kTries};
};

TEST_F(EnableSequenceTest, AsksAtOnceAndAgainAfterThePatience) {
  EXPECT_TRUE(sequence.asks(at(0)));
  EXPECT_FALSE(sequence.asks(at(1)));
  EXPECT_FALSE(sequence.asks(at(49)));
  EXPECT_TRUE(sequence.asks(at(50)));
  EXPECT_FALSE(sequence.asks(at(99)));
  EXPECT_EQ(sequence.askedFirst(), at(0));
}

TEST_F(EnableSequenceTest, FailsWhenTheLastTryHasGoneUnanswered) {
  for (int i = 0; i < kTries; ++i) EXPECT_TRUE(sequence.asks(at(50 * i)));
  EXPECT_FALSE(sequence.asks(at(149)));
  EXPECT_FALSE(sequence.exhausted(at(149)));
  EXPECT_EQ(sequence.progress(), SequenceProgress::kPending);
  EXPECT_TRUE(sequence.exhausted(at(150)));
  EXPECT_FALSE(sequence.asks(at(150)));
  EXPECT_TRUE(sequence.failed());
  EXPECT_EQ(sequence.step(), Step::kStop);
  EXPECT_FALSE(sequence.asks(at(1000)));
}

TEST_F(EnableSequenceTest, CountsAnAnswerOnlyToTheStepThatWasAskedFor) {
  EXPECT_FALSE(sequence.awaits());
  EXPECT_FALSE(sequence.awaits(Step::kStop));
  EXPECT_TRUE(sequence.asks(at(0)));
  EXPECT_TRUE(sequence.awaits(Step::kStop));
  EXPECT_FALSE(sequence.awaits(Step::kEnable));
}

TEST_F(EnableSequenceTest, GivesTheNextStepTriesOfItsOwn) {
  for (int i = 0; i < kTries; ++i) EXPECT_TRUE(sequence.asks(at(50 * i)));
  sequence.next(Step::kEnable);
  EXPECT_TRUE(sequence.at(Step::kEnable));
  EXPECT_FALSE(sequence.awaits());
  for (int i = 0; i < kTries; ++i) EXPECT_TRUE(sequence.asks(at(110 + 50 * i)));
  EXPECT_EQ(sequence.askedFirst(), at(110));
  EXPECT_FALSE(sequence.asks(at(260)));
  EXPECT_TRUE(sequence.failed());
}

TEST_F(EnableSequenceTest, AsksNothingMoreWhenItIsOver) {
  EXPECT_TRUE(sequence.asks(at(0)));
  sequence.finish();
  EXPECT_TRUE(sequence.done());
  EXPECT_FALSE(sequence.awaits());
  EXPECT_FALSE(sequence.at(Step::kStop));
  EXPECT_FALSE(sequence.asks(at(50)));
  EXPECT_FALSE(sequence.exhausted(at(500)));
}

TEST_F(EnableSequenceTest, BeginsAnewAfterAFailure) {
  EXPECT_TRUE(sequence.asks(at(0)));
  sequence.fail();
  EXPECT_FALSE(sequence.awaits());
  sequence.begin(Step::kStop);
  EXPECT_EQ(sequence.progress(), SequenceProgress::kPending);
  EXPECT_TRUE(sequence.asks(at(1)));
}

TEST(DriveDuty, EveryKindOfFrameHasADuty) {
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll, FrameKind::kDisable}) {
    EXPECT_EQ(dutyOf(kind), DriveDuty::kRest);
  }
  EXPECT_EQ(dutyOf(FrameKind::kEnable), DriveDuty::kEnable);
  for (const auto kind :
       {FrameKind::kIdle, FrameKind::kDamp, FrameKind::kBrake, FrameKind::kHold, FrameKind::kCommand}) {
    EXPECT_EQ(dutyOf(kind), DriveDuty::kObey);
  }
}

}  // namespace
}  // namespace rc10::enable_sequence_test
