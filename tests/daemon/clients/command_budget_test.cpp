#include "daemon/clients/command_budget.hpp"

#include <gtest/gtest.h>

namespace rc10::test::command_budget_test {
namespace {

using namespace std::chrono_literals;

class CommandBudgetTest : public ::testing::Test {
 protected:
  /// Number of these messages that go through in this millisecond.
  int send(std::string_view client, int messages, std::size_t setpoints) {
    int sent = 0;
    for (int i = 0; i < messages; ++i) sent += budget.spend(client, setpoints, now) ? 1 : 0;
    return sent;
  }

  CommandBudget budget{1ms};
  MonotonicTime now{1h};
};

TEST_F(CommandBudgetTest, AMessageATickForEveryMotorIsNeverRefused) {
  for (int ms = 0; ms < 1000; ++ms, now += 1ms) {
    for (const auto* client : {"a", "b", "c", "d", "e", "f", "g", "h"}) EXPECT_EQ(send(client, 1, 128), 1);
  }
}

TEST_F(CommandBudgetTest, ABurstOfAFullRingIsNotRefused) { EXPECT_EQ(send("a", 64, 8), 64); }

TEST_F(CommandBudgetTest, AFloodLeavesHalfTheRingToOthers) {
  (void)send("flood", 1000, 1);
  for (int ms = 0; ms < 100; ++ms) {
    now += 1ms;
    EXPECT_LE(send("flood", 1000, 1), 32);
  }
}

TEST_F(CommandBudgetTest, AFloodLeavesHalfTheRingOfATickToOthersAtEachRate) {
  budget = CommandBudget{10ms};
  (void)send("flood", 1000, 1);
  for (int tick = 0; tick < 100; ++tick) {
    int sent = 0;
    for (int ms = 0; ms < 10; ++ms, now += 1ms) sent += send("flood", 100, 1);
    EXPECT_LE(sent, 33);
    EXPECT_EQ(send("quiet", 1, 8), 1);
  }
}

TEST_F(CommandBudgetTest, FloodsShareAndAQuietClientIsHeard) {
  int sent = 0;
  for (int ms = 0; ms < 1000; ++ms, now += 1ms) {
    sent += send("flood", 100, 128) + send("flood2", 100, 128);
    EXPECT_EQ(send("quiet", 1, 8), 1);
  }
  EXPECT_LE(sent, 16 * 3 + 1000 * 8) << "of all together, in setpoints 1,024 a millisecond";
}

TEST_F(CommandBudgetTest, WhoIsSilentLeavesItsShareToTheOthers) {
  (void)send("other", 1, 1);
  (void)send("a", 100, 128);
  now += 1s;
  EXPECT_EQ(send("a", 100, 128), 16);
  now += 1ms;
  EXPECT_EQ(send("a", 100, 128), 8);
}

TEST_F(CommandBudgetTest, ManyNamesAreForgottenAgain) {
  for (int i = 0; i < 1000; ++i, now += 1ms) EXPECT_EQ(send(std::to_string(i), 1, 1), 1);
}

}  // namespace
}  // namespace rc10::test::command_budget_test
