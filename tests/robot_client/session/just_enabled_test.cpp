#include "robot_client/session/just_enabled.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "robot_client/session/obstacle.hpp"

namespace rc10 {
inline namespace robot_client {
namespace just_enabled_test {
namespace {

TEST(JustEnabled, AStateThatMayBeOlderThanTheAnswerRefusesNothing) {
  auto state = std::make_shared<RobotState>();
  state->motors.resize(2);
  state->motors[0].name = "lift";
  state->motors[1].name = "wheel";
  JustEnabled enabled;
  enabled.answered({"lift"}, 7);
  for (const std::uint64_t older : {7U, 8U}) {
    const auto corrected = enabled.corrected(state, older);
    EXPECT_FALSE(obstacle(*corrected, "lift", Mode::kTotalAngle)) << "zeroed before, too";
    EXPECT_TRUE(obstacle(*corrected, "wheel", Mode::kVelocity));
  }
  EXPECT_EQ(enabled.corrected(state, 9), state) << "news";
  enabled.release({"lift"});
  EXPECT_EQ(enabled.corrected(state, 8), state);
}

TEST(JustEnabled, IsReleasedByNameOrAltogether) {
  auto state = std::make_shared<RobotState>();
  for (const auto* name : {"lift", "wheel"}) state->motors.emplace_back().name = name;
  JustEnabled enabled;
  enabled.answered({"lift", "wheel"}, 7);
  enabled.release({"lift"});
  EXPECT_FALSE(obstacle(*enabled.corrected(state, 7), "wheel", Mode::kVelocity));
  EXPECT_TRUE(obstacle(*enabled.corrected(state, 7), "lift", Mode::kVelocity));
  enabled.release({});
  EXPECT_EQ(enabled.corrected(state, 7), state);
}

}  // namespace
}  // namespace just_enabled_test
}  // namespace robot_client
}  // namespace rc10
