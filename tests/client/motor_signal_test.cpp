#include "client/motor_signal.hpp"

#include <gmock/gmock.h>

#include "fake_rc10d.hpp"
#include "sample_messages.hpp"

namespace rc10::client::test::motor_signal_test {
namespace {

using rc10::test::heroState;
using rc10::test::heroWelcome;
using testing::HasSubstr;

TEST(MotorSignal, IsFoundWithAndWithoutItsUnit) {
  for (const char* text : {"front_left.velocity_rpm", "front_left.velocity"}) {
    const auto signal = findSignal(heroWelcome(), text);
    ASSERT_TRUE(signal) << signal.error().message;
    EXPECT_EQ(signal->name, "front_left.velocity_rpm");
    EXPECT_NEAR(signal->of(heroState()), 118.26, 1e-4);
  }
}

TEST(MotorSignal, TheErrorListsWhatThereIs) {
  EXPECT_THAT(findSignal(heroWelcome(), "front_left.speed").error().message, HasSubstr("velocity_rpm"));
  EXPECT_THAT(findSignal(heroWelcome(), "nobody.velocity").error().message, HasSubstr("front_left, yaw"));
  EXPECT_THAT(findSignal(heroWelcome(), "velocity").error().message, HasSubstr("front_left.velocity"));
}

}  // namespace
}  // namespace rc10::client::test::motor_signal_test
