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

}  // namespace
}  // namespace setpoint_test
}  // namespace robot_client
}  // namespace rc10
