#include "robot_client/session/leaving.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace leaving_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

RobotState robotWith(const std::vector<std::string>& motors) {
  RobotState state;
  for (const auto& motor : motors) state.motors.emplace_back().name = motor;
  return state;
}

std::vector<std::string> motorsOf(const MotorSetpoints& setpoints) {
  std::vector<std::string> motors;
  for (const auto& order : setpoints) motors.push_back(order.motor);
  return motors;
}

TEST(Leaving, CoastsWhatWasCommandedOnce) {
  const auto state = robotWith({"left", "right"});
  Leaving leaving;
  EXPECT_THAT(leaving.coasts(&state), IsEmpty());
  leaving.commanded({{"left", Setpoint::velocity(Rpm{10})}});
  leaving.commanded({{"left", Setpoint::velocity(Rpm{20})}});
  const auto coasts = leaving.coasts(&state);
  EXPECT_THAT(motorsOf(coasts), ElementsAre("left"));
  EXPECT_EQ(coasts.front().setpoint.mode, Mode::kCoast);
}

TEST(Leaving, DisablesWhatWasEnabledAndNotDisabled) {
  const auto state = robotWith({"left", "right"});
  Leaving leaving;
  EXPECT_EQ(leaving.toDisable(&state), std::nullopt);
  leaving.enabled({"left", "right"});
  EXPECT_EQ(leaving.toDisable(&state), "left,right");
  leaving.disabled({"left"});
  EXPECT_EQ(leaving.toDisable(&state), "right");
  leaving.disabled({});
  EXPECT_EQ(leaving.toDisable(&state), std::nullopt);
}

TEST(Leaving, DisablesAllWhereAllWereEnabledThoughOneWasDisabled) {
  Leaving leaving;
  leaving.enabled({});
  leaving.disabled({"left"});
  EXPECT_EQ(leaving.toDisable(nullptr), "");
}

TEST(Leaving, LeavesOutMotorsThatTheRobotNoLongerHas) {
  const auto state = robotWith({"right"});
  Leaving leaving;
  leaving.commanded({{"left", Setpoint::coast()}, {"right", Setpoint::coast()}});
  leaving.enabled({"left", "right"});
  EXPECT_THAT(motorsOf(leaving.coasts(&state)), ElementsAre("right"));
  EXPECT_EQ(leaving.toDisable(&state), "right");
  EXPECT_THAT(leaving.coasts(nullptr), IsEmpty());
  EXPECT_EQ(leaving.toDisable(nullptr), "left,right") << "no state came, but rc10d has answered";
}

TEST(Leaving, ForgetsAll) {
  const auto state = robotWith({"left"});
  Leaving leaving;
  leaving.commanded({{"left", Setpoint::coast()}});
  leaving.enabled({});
  leaving.forget();
  EXPECT_THAT(leaving.coasts(&state), IsEmpty());
  EXPECT_EQ(leaving.toDisable(&state), std::nullopt);
}

}  // namespace
}  // namespace leaving_test
}  // namespace robot_client
}  // namespace rc10
