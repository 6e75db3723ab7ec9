#include "faults/match.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace rc10::test::match_test {
namespace {

using namespace std::chrono_literals;

TEST(MatchTest, ASoundRobotPlaysWithoutAStopThatNobodyAskedFor) {
  SeededChoices choices{7};
  Match match{choices};
  while (match.robotTime() < 30s) match.tick();
  EXPECT_TRUE(match.nuisances().empty()) << match.nuisances().front();
  EXPECT_EQ(match.times("match"), 1U);
  EXPECT_GT(match.times("shove"), 0U);
  EXPECT_GT(match.activeShare(), 0.3);
  EXPECT_EQ(match.idlers(0.8), "");
}

TEST(MatchTest, TheJudgeSeesAStopThatNobodyAskedFor) {
  constexpr std::size_t kBelt = 9;
  SeededChoices choices{7};
  Match match{choices};
  while (match.robotTime() < 4500ms) match.tick();  // it plays, and no trouble has come yet
  ASSERT_TRUE(match.nuisances().empty()) << match.nuisances().front();
  match.unplugUnnoticed(kBelt);
  while (match.robotTime() < 4900ms) match.tick();
  ASSERT_EQ(match.nuisances().size(), 1U);
  EXPECT_NE(match.nuisances().front().find("belt is OFFLINE: silence"), std::string::npos)
      << match.nuisances().front();
}

TEST(MatchTest, TheJudgeSeesMotorsThatStandThoughTheyAreCommanded) {
  SeededChoices choices{7};
  Match match{choices};
  match.sendNothing();
  while (match.robotTime() < 10s) match.tick();
  EXPECT_TRUE(match.nuisances().empty()) << match.nuisances().front();
  EXPECT_NE(match.idlers(0.8).find("front_left 0 %"), std::string::npos) << match.idlers(0.8);
  EXPECT_NE(match.idlers(0.8).find("leg_right 0 %"), std::string::npos) << match.idlers(0.8);
}

TEST(MatchTest, APersonTurnsBackAShaftThatAHandHasLedOutOfItsTravel) {
  constexpr std::size_t kYaw = 5;
  SeededChoices choices{7};
  Match match{choices};
  while (match.robotTime() < 4500ms) match.tick();  // it plays, and no trouble has come yet
  match.leadAstray(kYaw);
  while (match.robotTime() < 20s) match.tick();
  EXPECT_EQ(match.times("turned back"), 1U);
  EXPECT_TRUE(match.nuisances().empty()) << match.nuisances().front();
}

}  // namespace
}  // namespace rc10::test::match_test
