#include "rc10/setpoint.hpp"

#include <gtest/gtest.h>

#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {
namespace setpoint_test {
namespace {

using namespace rc10::literals;

TEST(Setpoint, WhatNoMotorCanBeGivenIsRefused) {
  EXPECT_TRUE(Setpoint::velocity(120_rpm).check());
  EXPECT_TRUE(Setpoint::impedance(10_deg, 2.0, 0.1).check());
  EXPECT_FALSE(Setpoint::velocity(Rpm{kUnknown}).check());
  EXPECT_FALSE(Setpoint::duty(1.01).check());
  EXPECT_FALSE(Setpoint::impedance(10_deg, -1.0, 0.1).check());
  EXPECT_FALSE(Setpoint::impedance(10_deg, 1.0, kUnknown).check());
  EXPECT_FALSE(Setpoint::angle(10_deg, {.torque_nm = 1e39}).check());
}

TEST(Setpoint, AFieldThatItsModeDoesNotUseIsRefused) {
  const FeedForward speed{.velocity = 10_rpm};
  const FeedForward torque{.torque_nm = 0.5};
  const auto withForward = [](Setpoint setpoint, const FeedForward& forward) {
    setpoint.forward = forward;
    return setpoint.check();
  };
  EXPECT_TRUE(withForward(Setpoint::angle(10_deg), speed));
  EXPECT_FALSE(withForward(Setpoint::velocity(10_rpm), speed));
  EXPECT_FALSE(withForward(Setpoint::duty(0.5), speed));
  EXPECT_TRUE(withForward(Setpoint::velocity(10_rpm), torque));
  EXPECT_FALSE(withForward(Setpoint::duty(0.5), torque));
}

}  // namespace
}  // namespace setpoint_test
}  // namespace robot_client
}  // namespace rc10
