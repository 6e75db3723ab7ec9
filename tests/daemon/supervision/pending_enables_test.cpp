#include "daemon/supervision/pending_enables.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace rc10::test::pending_enables_test {
namespace {

MotorSet motors(std::initializer_list<std::size_t> members) {
  MotorSet set;
  for (const auto motor : members) set.set(motor);
  return set;
}

OrderResult request(std::uint64_t id) {
  OrderResult result;
  result.id = id;
  return result;
}

class PendingEnablesTest : public ::testing::Test {
 protected:
  void settle(std::size_t motor, Refusal outcome) {
    pending.settle(motor, outcome, [this](const OrderResult& result) { answers.push_back(result); });
  }

  PendingEnables pending;
  std::vector<OrderResult> answers;
};

TEST_F(PendingEnablesTest, AnswersWithTheLastMotorOfARequest) {
  pending.add(request(7), motors({1, 4}));
  settle(4, Refusal::kDriveRefused);
  EXPECT_TRUE(answers.empty());
  settle(1, Refusal::kNone);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].id, 7U);
  EXPECT_EQ(answers[0].motors[1], Refusal::kNone);
  EXPECT_EQ(answers[0].motors[4], Refusal::kDriveRefused);
}

TEST_F(PendingEnablesTest, AnswersEveryRequestThatWaitsForOneMotor) {
  pending.add(request(1), motors({0}));
  pending.add(request(2), motors({0}));
  settle(0, Refusal::kNone);
  EXPECT_EQ(answers.size(), 2U);
  settle(0, Refusal::kFaulted);
  EXPECT_EQ(answers.size(), 2U) << "answered once";
}

TEST_F(PendingEnablesTest, AMotorThatNobodyWaitsForAnswersNothing) {
  pending.add(request(1), motors({0}));
  settle(1, Refusal::kNone);
  EXPECT_TRUE(answers.empty());
}

TEST_F(PendingEnablesTest, AnAnsweredRequestLeavesItsPlaceToAnother) {
  for (std::uint64_t id = 0; id < kMaxOpenRequests; ++id) {
    EXPECT_FALSE(pending.full());
    pending.add(request(id), motors({static_cast<std::size_t>(id)}));
  }
  EXPECT_TRUE(pending.full());
  settle(3, Refusal::kNone);
  EXPECT_FALSE(pending.full());
  pending.add(request(99), motors({3}));
  settle(3, Refusal::kNone);
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[1].id, 99U);
}

}  // namespace
}  // namespace rc10::test::pending_enables_test
