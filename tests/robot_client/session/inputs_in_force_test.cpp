#include "robot_client/session/inputs_in_force.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace test::inputs_in_force_test {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;
using testing::SizeIs;

constexpr MonotonicTime kStart{1000s};

TEST(InputsInForce, TheLastOfEachModuleEndWithTheirPriority) {
  InputsInForce in_force;
  in_force.give("base", {{"vx_m_s", 1.0}}, {.validity = 1000ms}, kStart);
  in_force.give("base", {{"vx_m_s", 0.5}}, {.validity = 1000ms, .priority = 9}, kStart + 10ms);
  in_force.give("gimbal", {{"yaw_deg", 3.0}}, {.validity = 200ms}, kStart + 20ms);
  const auto last = in_force.takeAll(kStart + 30ms);
  ASSERT_THAT(last, SizeIs(2));
  const auto& base = last.at("base");
  EXPECT_EQ(base.inputs, (Signals{{"vx_m_s", 0.5}}));
  EXPECT_EQ(base.options.validity, 1ms);
  EXPECT_EQ(base.options.priority, 9);
  EXPECT_FALSE(last.at("gimbal").options.priority);
  EXPECT_THAT(in_force.takeAll(kStart + 30ms), IsEmpty()) << "they have ended";
}

TEST(InputsInForce, OnesThatHaveLapsedAreNotSaidAgain) {
  const auto after = [](std::chrono::milliseconds validity, Duration since) {
    InputsInForce in_force;
    in_force.give("base", {{"vx_m_s", 1.0}}, {.validity = validity}, kStart);
    return in_force.takeAll(kStart + since);
  };
  EXPECT_THAT(after(200ms, 199ms), SizeIs(1));
  EXPECT_THAT(after(200ms, 200ms), IsEmpty());
  EXPECT_THAT(after(0ms, 49ms), SizeIs(1)) << "rc10d's default";
  EXPECT_THAT(after(0ms, 50ms), IsEmpty());
}

TEST(InputsInForce, OnesFromBeforeAMotorWasEnabledAreNotSaidAgain) {
  const auto after = [](std::int32_t code, const std::string& text) {
    InputsInForce in_force;
    in_force.give("base", {{"vx_m_s", 1.0}}, {.validity = 1000ms}, kStart);
    in_force.onEvent({.code = code, .source = "wheel", .text = text});
    return in_force.takeAll(kStart);
  };
  EXPECT_THAT(after(100, "READY -> ENABLING"), IsEmpty());
  EXPECT_THAT(after(100, "ENABLING -> ACTIVE"), SizeIs(1));
  EXPECT_THAT(after(100, "ACTIVE -> FAULT (stalled)"), SizeIs(1)) << "others of the module may go on";
  EXPECT_THAT(after(103, "READY -> ENABLING"), SizeIs(1)) << "another event";
}

}  // namespace
}  // namespace test::inputs_in_force_test
}  // namespace robot_client
}  // namespace rc10
