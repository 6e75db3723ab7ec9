#include "client/jog_keys.hpp"

#include <gmock/gmock.h>

namespace rc10::client::test::jog_keys_test {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

MonotonicTime at(int ms) { return MonotonicTime{milliseconds{ms}}; }

TEST(JogKeys, ArrowsOfBothKindsAreKeys) {
  JogKeys keys;
  EXPECT_THAT(keys.take("\x1b[A\x1b[B\x1bOC\x1bOD"),
              ElementsAre(JogKey::kFaster, JogKey::kSlower, JogKey::kForward, JogKey::kBackward));
}

TEST(JogKeys, AnArrowMayComeInParts) {
  JogKeys keys;
  EXPECT_THAT(keys.take("\x1b"), ElementsAre(JogKey::kStop)) << "it may be the key ESC";
  EXPECT_THAT(keys.take("["), IsEmpty());
  EXPECT_THAT(keys.take("C"), ElementsAre(JogKey::kForward));
}

TEST(JogKeys, EveryOtherKeyStops) {
  JogKeys keys;
  EXPECT_THAT(keys.take(" x\x1b[Z"), ElementsAre(JogKey::kStop, JogKey::kStop, JogKey::kStop));
  EXPECT_THAT(keys.take("q"), ElementsAre(JogKey::kQuit));
}

TEST(JogSpeed, TurnsOnlyWhileKeysCome) {
  JogSpeed speed(30.0, 100.0, milliseconds{400});
  EXPECT_EQ(speed.target(at(0)), 0.0);
  speed.press({JogKey::kForward}, at(0));
  EXPECT_EQ(speed.target(at(399)), 30.0);
  EXPECT_EQ(speed.target(at(400)), 0.0);
  for (int ms = 100; ms < 500; ms += 100) speed.press({}, at(ms));
  speed.press({JogKey::kBackward}, at(500));
  EXPECT_EQ(speed.target(at(600)), -30.0);
  for (int ms = 600; ms < 800; ms += 100) speed.press({}, at(ms));
  speed.press({JogKey::kBackward}, at(800));
  EXPECT_EQ(speed.target(at(1100)), -30.0);
}

TEST(JogSpeed, KeysThatWereHeldDuringAPauseOfTheProgramTurnNothing) {
  JogSpeed speed(30.0, 100.0, milliseconds{400});
  speed.press({JogKey::kForward}, at(0));
  speed.press({JogKey::kForward, JogKey::kBackward, JogKey::kForward}, at(1500));
  EXPECT_EQ(speed.target(at(1500)), 0.0);
  speed.press({JogKey::kForward}, at(1530));
  EXPECT_EQ(speed.target(at(1540)), 30.0) << "still held";
  speed.press({JogKey::kStop}, at(1700));
  EXPECT_EQ(speed.target(at(1701)), 0.0) << "a stop counts whenever it was typed";
}

TEST(JogSpeed, BeginsNoFasterThanItsLimit) {
  JogSpeed speed(5000.0, 200.0, milliseconds{400});
  speed.press({JogKey::kForward}, at(0));
  EXPECT_EQ(speed.target(at(1)), 200.0);
}

TEST(JogSpeed, StopsAtOnceWhenToldTo) {
  JogSpeed speed(30.0, 100.0, milliseconds{400});
  speed.press({JogKey::kForward}, at(0));
  speed.press({JogKey::kStop}, at(1));
  EXPECT_EQ(speed.target(at(2)), 0.0);
}

TEST(JogSpeed, UpAndDownChangeTheSpeedWithinItsLimitAndMoveNothing) {
  JogSpeed speed(80.0, 90.0, milliseconds{400});
  speed.press({JogKey::kFaster}, at(0));
  EXPECT_EQ(speed.speed(), 90.0);
  EXPECT_EQ(speed.target(at(1)), 0.0);
  for (int i = 0; i < 100; ++i) speed.press({JogKey::kSlower}, at(1));
  EXPECT_EQ(speed.speed(), 0.5);
}

}  // namespace
}  // namespace rc10::client::test::jog_keys_test
